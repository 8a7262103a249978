"""``sample 100ms hold``: each variable has its latest value, of recordings and of streams alike."""

from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import BoundError, ParseError, TraceError, UsageError
from rtamt.language.parsing.sampling_clause import Sampling
from rtamt.signals.sampling import HeldSampler

TEXT = "sample 100ms hold for 500ms; always(x <= 3 -> y >= 1)"
X = ([0.0, 0.12, 0.33, 0.6], [1, 2, 4, 1])
Y = ([0.0, 0.05, 0.6], [0, 1, 1])


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("sample 100ms; x > 3", Sampling(Fraction(1, 10))),
        ("sample 1/3s hold x > 3", Sampling(Fraction(1, 3), hold=True)),
        ("sample 2 hold for 1min\nx > 3", Sampling(Fraction(2), hold=True, limit=Fraction(60))),
        ("input float x sample 100 ms hold require R: x > 3", Sampling(Fraction(1, 10), hold=True)),
        ("sample 1s hold skip nan x > 3", Sampling(Fraction(1), hold=True, skip_nan=True)),
        (
            "sample 1s hold for 2s skip nan;x > 3",
            Sampling(Fraction(1), hold=True, limit=Fraction(2), skip_nan=True),
        ),
        ("sample 1s hold\nskip > 3", Sampling(Fraction(1), hold=True)),
        ("sample 1s\nhold > 3", Sampling(Fraction(1))),
        ("sample 1s hold = 3; x > hold", Sampling(Fraction(1))),
        ("sample > 3", None),
        ("float sample; sample > 3", None),
    ],
)
def test_what_a_rule_says(text, rule):
    spec = rtamt.parse(text)
    assert spec.sampling == spec.document.sampling == rule
    assert spec.period == (None if rule is None else rule.period)
    assert rtamt.parse(text, time="dense").domain.continuous


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("sample 1s sample 1s x > 3", ParseError, "the sampling rule is given twice"),
        ("sample 0s x > 3", ParseError, "the sampling period is '0s'; it must be positive"),
        ("sample 1sec x > 3", ParseError, "'sec' is not a unit of time; units: h, min, s, ms, us, ns"),
        ("sample 1s hold for ever; x > 3", ParseError,
         "expected the longest time for which a value is held, such as 100ms, got 'ever'"),
        ("sample 1s hold skip x > 3", ParseError, "expected 'nan' after 'skip', got 'x'"),
        ("sample 1s skip nan x > 3", ParseError, "'skip nan' stands after 'hold': write sample 1s hold skip nan"),
        ("x > 3; sample 1s", ParseError, "declarations and annotations stand before the first formula"),
        ("sample 100ms; always[0:150ms](x > 3)", BoundError, "The operator bound must be a multiple of the sampling "
         "period: 150 ms is not a whole number of periods of 100 ms; change the bound or the period"),
    ],
)  # fmt: skip
def test_messages(text, kind, message):
    with pytest.raises(kind) as caught:
        rtamt.parse(text)
    assert caught.value.message == message


def recordings():
    """Return one recording in every form."""
    yield rtamt.read({"x": X, "y": Y})
    yield {"x": X, "y": Y}
    yield {"x": list(zip(*X, strict=True)), "y": np.column_stack(Y)}
    times = sorted({*X[0], *Y[0]})
    rows = {name: [dict(zip(*s, strict=True)).get(t) for t in times] for name, s in (("x", X), ("y", Y))}
    yield {"time": times, **rows}
    yield rtamt.read({"time": times, **rows})


@pytest.mark.parametrize("data", list(recordings()))
def test_multi_rate_recordings_are_sampled(data):
    spec = rtamt.parse(TEXT)
    result = spec.evaluate(data)
    assert result.signal.times.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    assert result.trace.columns["x"].tolist() == [1, 1, 2, 2, 4, 4, 1]
    assert result.trace.columns["y"].tolist() == [0, 1, 1, 1, 1, 1, 1]
    assert result.robustness == -1.0
    assert rtamt.evaluate_all([spec], data)[0].signal.values.tolist() == result.signal.values.tolist()
    assert spec.evaluate(data, period="300ms").signal.times.tolist() == [0.0, 0.3, 0.6]
    late = rtamt.parse("sample 100ms hold for 200ms; always(x <= 3 -> y >= 1)")
    with pytest.raises(TraceError) as caught:
        late.evaluate(data)
    assert str(caught.value) == (
        "'y' has no sample from 0.05 s to 0.3 s, longer than the 200 ms for which a value is held: fill the gap, or "
        "hold it for longer"
    )


def test_a_rule_without_hold_is_the_period():
    spec = rtamt.parse("sample 100ms; x <= 3")
    with pytest.raises(TraceError, match="100 ms"):
        spec.evaluate({"time": [0, 0.2, 0.4], "x": [1, 2, 3]})
    assert spec.evaluate({"time": [0, 0.1], "x": [1, 2]}).robustness == 2.0
    assert float(spec.monitor().period) == 0.1


def test_dense_time_and_data_without_times_are_not_sampled():
    spec = rtamt.parse(TEXT)
    assert spec.evaluate({"x": X, "y": Y}, time="dense").trace.samples == 5
    assert len(spec.evaluate({"x": [1, 2], "y": [3, 4]}).signal) == 2
    frame = pd.DataFrame({"time": [0, 0.15, 0.3], "x": [1, 2, 3], "y": [3, 3, 4]})
    assert spec.evaluate(frame).trace.columns["x"].tolist() == [1, 1, 2, 3]


@pytest.mark.parametrize(
    ("settings", "period"),
    [
        ({}, 0.1),
        ({"time": rtamt.Discrete()}, 0.1),
        ({"time": rtamt.Discrete(period="50ms")}, 0.05),
        ({"period": 0.05}, 0.05),
    ],
)
def test_a_period_that_is_given_replaces_that_of_the_rule(settings, period):
    spec = rtamt.parse("sample 100ms hold; x <= 3", **settings)
    assert (float(spec.monitor().period), float(spec.sampling.period)) == (period, period)
    assert len(spec.evaluate({"x": X}).signal) == 1 + round(0.6 / period)


def test_what_a_rule_does_not_do():
    spec = rtamt.parse(TEXT)
    with pytest.raises(UsageError, match="read the data with rtamt"):
        spec.evaluate({"x": X, "y": Y}, time_unit="ms")
    with pytest.raises(UsageError, match="'sample 100ms hold for 500ms' samples the whole recording"):
        rtamt.check_stream(spec, [{"x": X, "y": Y}])
    with pytest.raises(UsageError, match="hold_for= is for how='hold', got how='linear'"):
        rtamt.read({"x": X}).resample(1, how="linear", hold_for=3)


TIMES = st.lists(st.integers(0, 60), min_size=1, max_size=12, unique=True).map(sorted)


PERIODS, LIMITS = st.sampled_from(("1/10", "1/4", "1/3")), st.sampled_from((None, "1/2", "2"))


@given(TIMES, TIMES, PERIODS, LIMITS, st.sampled_from("fM"))
def test_a_stream_and_its_recording_have_the_same_samples(first, second, period, limit, kind):
    def date_of(k):
        return k / 20 if kind == "f" else np.datetime64(1_700_000_000_000_000_000 + k * 50_000_000, "ns")

    if kind == "M" and period == "1/3":
        period = "1/8"  # no whole number of nanoseconds
    hold_for = None if limit is None else Fraction(limit)
    channels = {
        name: (np.array([date_of(k) for k in times]), np.array(times) * weight)
        for name, times, weight in (("x", first, 1.0), ("y", second, -1.0))
    }
    trace = rtamt.read(channels)

    def stream():
        sampler = HeldSampler(
            ("x", "y"), Sampling(Fraction(period), hold=True, limit=hold_for), Fraction(period)
        )
        for k in sorted({*first, *second}):
            values = {"x": float(k)} if k in first else {}
            yield from sampler.take(date_of(k), values | ({"y": -float(k)} if k in second else {}))
        yield from sampler.finish()

    try:
        expected = trace.resample(period, "hold", hold_for)
    except TraceError:
        expected = None
    if expected is None:
        with pytest.raises(TraceError, match="for which a value is held"):
            list(stream())
        return
    found = list(stream())
    assert np.array_equal(np.array([time for time, _ in found]), expected["x"].times)
    for name in ("x", "y"):
        assert [values[name] for _, values in found] == expected[name].values.tolist()


def test_wrong_streams():
    sampler = HeldSampler(("x", "y"), Sampling(Fraction(1), hold=True), Fraction(1))
    (sampler.take(1.0, {"x": 1}))
    with pytest.raises(TraceError, match=r"time does not increase: 0.5 s comes after 1 s; sort the samples"):
        (sampler.take(0.5, {"y": 1}))
    with pytest.raises(TraceError, match=r"'x' has two samples at 1 s: keep one of them"):
        (sampler.take(1.0, {"x": 1}))
    assert (sampler.take(1.0, {"y": 2})) == []
    assert (sampler.take(2.5, {"y": 3})) == [(1.0, {"x": 1, "y": 2}), (2.0, {"x": 1, "y": 2})]


def test_after_a_value_that_was_too_old_a_stream_goes_on():
    sampler = HeldSampler(("x",), Sampling(Fraction(1), hold=True, limit=Fraction(2)), Fraction(1))
    (sampler.take(0.0, {"x": 1}))
    with pytest.raises(TraceError, match=r"'x' has no sample from 0 s to 3 s"):
        (sampler.take(5.5, {"x": 2}))
    assert (sampler.take(7.0, {"x": 3})) == [(6.0, {"x": 2})]
    assert sampler.finish() == [(7.0, {"x": 3})]


def test_samples_that_are_nan_are_skipped():
    spec = rtamt.parse("sample 1s hold for 2s skip nan; always(x <= 3)")
    assert str(spec.sampling) == "sample 1s hold for 2s skip nan"
    for x in ([1, np.nan, np.nan, 2], np.array([1, np.nan, np.nan, 2])):
        data = {"time": [0, 1, 2, 3], "x": x}
        for each in (data, rtamt.read(data, skip_nan=()), {"x": (data["time"], x)}):
            if isinstance(each, dict) or np.isnan(each["x"].values).any():
                assert spec.evaluate(each).trace.columns["x"].tolist() == [1, 1, 1, 2]
    with pytest.raises(TraceError, match="'x' has no sample from 0 s to 3 s"):
        spec.evaluate({"time": [0, 1, 2, 3, 4], "x": [1, np.nan, np.nan, np.nan, 2]})
    with pytest.raises(TraceError, match="'x' is NaN at sample 1"):
        rtamt.parse("sample 1s hold; always(x <= 3)").evaluate({"time": [0, 1, 2], "x": [1, np.nan, 2]})


@pytest.mark.parametrize(
    "times",
    [
        np.arange(10) * 0.1,
        np.cumsum(np.full(10, 0.1)) - 0.1,
        1.7e9 + np.arange(10) * 0.1,
        np.arange(10) * 0.1 - 1e-16 * np.arange(10),
    ],
    ids=["products", "sums", "epoch", "short"],
)
def test_samples_on_rounded_instants_were_left_out(times):
    values = np.full(10, 80.0)
    values[3] = 1.0
    result = rtamt.parse("sample 100ms hold  float x  always(x > 50)").evaluate({"time": times, "x": values})
    assert result.robustness == -49
    assert len(result.signal.times) == 10
    read = rtamt.read({"time": times, "x": values}).resample("100ms")
    assert read["x"].values.tolist() == values.tolist()
    assert read.losses == ()
