"""A time domain is given by its name or as an object; every time domain has the same interface."""

from fractions import Fraction

import numpy as np
import pytest

import rtamt
from rtamt.engine import engine_of
from rtamt.plot.x_axis import XAxis
from rtamt.signals.time_domains import DOMAINS, time_domain

TEXT = "always[0:100ms](x >= 3)"
OBJECTS = {
    "discrete": (rtamt.Discrete(period="50ms", tolerance=0.2), {"period": "50ms", "tolerance": 0.2}),
    "dense": (rtamt.Dense(resolution="1us"), {"resolution": "1us"}),
}
DATA = {"time": [0.0, 0.05, 0.1, 0.15], "x": [5, 4, 6, 3]}


def test_every_time_domain_has_an_example_here() -> None:
    assert OBJECTS.keys() == DOMAINS.keys()


@pytest.mark.parametrize("name", DOMAINS)
def test_an_object_means_the_same_as_its_name_and_settings(name: str) -> None:
    domain, settings = OBJECTS[name]
    spec = rtamt.parse(TEXT)
    by_name, by_object = (
        spec.evaluate(DATA, **asked) for asked in ({"time": name, **settings}, {"time": domain})
    )
    assert by_object.signal.points() == by_name.signal.points()
    parsed = rtamt.parse(TEXT, time=domain)
    assert parsed.time == name
    assert parsed.evaluate(DATA).signal.points() == by_name.signal.points()
    monitors = [spec.monitor(time=name, **settings), spec.monitor(time=domain), parsed.monitor()]
    assert len({repr(monitor.update_many(DATA)) + repr(monitor.finish()) for monitor in monitors}) == 1
    settings.pop("tolerance", None)
    assert spec.compile(time=domain).to_bytes() == spec.compile(time=name, **settings).to_bytes()


@pytest.mark.parametrize("name", DOMAINS)
def test_settings_beside_an_object_are_rejected(name: str) -> None:
    domain, _ = OBJECTS[name]
    spec = rtamt.parse(TEXT)
    with pytest.raises(rtamt.UsageError) as error:
        spec.evaluate(DATA, time=domain, period=1, resolution="1ms")
    assert str(error.value) == (
        f"time is {domain!r}, which has its own settings: leave out period= and resolution="
    )
    with pytest.raises(rtamt.UsageError, match="leave out resolution="):
        rtamt.parse(TEXT, time=domain, resolution="1ms")


def test_settings_of_a_time_domain_are_checked() -> None:
    with pytest.raises(rtamt.UsageError, match="the sampling period is 0; it must be positive"):
        rtamt.Discrete(period=0)
    with pytest.raises(rtamt.UsageError, match="the tolerance is -1"):
        rtamt.Discrete(tolerance=-1)
    with pytest.raises(rtamt.UsageError, match="the resolution is '0s'; it must be positive"):
        rtamt.Dense("0s")
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse("x >= 3", time="desne")
    assert str(error.value) == (
        "unknown time domain 'desne'; did you mean 'dense'? (time domains: dense, discrete)"
    )


@pytest.mark.parametrize("name", DOMAINS)
def test_a_trace_counts_positions_from_the_first_instant(name: str) -> None:
    domain, _ = OBJECTS[name]
    trace = domain.record(DATA, ("x",))
    assert (trace.domain.name, trace.samples, trace.step) == (name, 4, domain.step)
    assert (trace.time(0), trace.time(trace.last)) == (0.0, 0.15)
    assert (trace.show(0), trace.show(trace.last)) == ("0 s", "0.15 s")
    assert [trace.position(trace.time(p)) for p in (0, trace.last)] == [0, trace.last]
    with pytest.raises(rtamt.UsageError):
        trace.position(7.0)
    times, values = trace.points("x", elapsed=False)
    assert times.tolist() == DATA["time"]
    assert values.tolist() == DATA["x"]
    assert trace.ends(elapsed=True) == (0.0, 0.15)
    assert trace.select(()).columns == {}


@pytest.mark.parametrize("name", DOMAINS)
def test_a_plot_of_times_in_milliseconds_ends_with_the_recording(name: str) -> None:
    spec = rtamt.parse("x >= 3", time=name)
    result = spec.evaluate({"time": np.array([0, 1000, 2000]), "x": [5, 4, 6]}, time_unit="ms")
    x_axis = XAxis.of(result.trace)
    assert (x_axis.start, x_axis.end) == (0.0, 2.0)
    assert x_axis.recorded("x")[0].tolist() == [0.0, 1.0, 2.0]


def test_every_time_domain_has_an_engine() -> None:
    for name in DOMAINS:
        domain = time_domain(name)
        assert set(engine_of(domain).backends) == {"cpp", "python"}
        assert domain.online.step in (Fraction(1), Fraction(1, 10**9))
