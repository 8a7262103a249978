"""What monitors of bounds reject in both time domains, in the same words."""

import copy

import pytest

import rtamt
from rtamt.signals.time_domains import DOMAINS


@pytest.fixture(params=[name for name, domain in DOMAINS.items() if "interval" in domain.parts])
def interval(request):
    def monitor(text="eventually[0:3](x >= 3)", **settings):
        return rtamt.parse(text, time=request.param).monitor(
            verdict="interval", ranges={"x": (0, 10)}, **settings
        )

    return monitor


def test_contradiction_is_rejected_with_one_sentence(interval):
    monitor = interval(lateness=2)
    for t in range(4):
        monitor.update(t, x=(4, 5))
    monitor.update(2, x=4.5)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(3, x=6)
    assert str(error.value) == (
        "'x' is 6 at time 3 s, which contradicts what was known of it, [4, 5]: correct it, "
        "or make the monitor with on_correction='replay'"
    )


def test_unbounded_future_at_every_sample_is_an_error_that_points_at_it(interval):
    with pytest.raises(rtamt.BoundError, match="ask for the start of the trace with at='start'"):
        interval("always x", at="every")


@pytest.fixture(params=[(time, backend) for time in ("discrete", "dense") for backend in ("cpp", "python")])
def buffering(request):
    """Return what makes monitors with a lateness, and how they name the first sample but one in a message."""
    time, backend = request.param
    name, domain = {
        "discrete": ("sample 1, at {} s,", rtamt.Discrete("1s")),
        "dense": ("the sample at {} s", rtamt.Dense("1s")),
    }[time]

    def monitor(**settings):
        spec = rtamt.parse("once[0:2](x >= 3)", time=domain, backend=backend)
        return spec.monitor(verdict="interval", **settings)

    return monitor, name


@pytest.mark.parametrize("copied", [False, True])
@pytest.mark.parametrize("time", [6, 3])
def test_first_sample_that_is_later_than_the_lateness_is_rejected_and_leaves_no_trace(
    buffering, time, copied
):
    made, name = buffering
    monitor, other = made(lateness=3), made(lateness=3)
    for each in (monitor, other):
        each.update(10, x=1.0)
    if copied:
        monitor = copy.copy(monitor)
    for _ in range(2):
        with pytest.raises(rtamt.TraceError) as error:
            monitor.update(time, x=5.0)
        assert str(error.value) == (
            f"{name.format(time)} is later than the lateness of 3 s allows: everything up to 6 s is final; "
            f"leave it out, or allow for more lateness"
        )
    for each in (monitor, other):
        each.update(7, x=4.0)  # exactly as late as it may be
        each.update(8, x=2.0)
        each.update(9, x=2.5)
    assert monitor.changes() == other.changes() != []
    assert monitor.finish() == other.finish()
    assert monitor.interval(10).lower == -0.5


def test_first_samples_need_not_come_in_order_up_to_the_lateness(buffering):
    made, name = buffering
    monitor = made(lateness=3)
    for time in (10, 8, 9):
        monitor.update(time, x=4.0)
    with pytest.raises(rtamt.TraceError, match=name.replace("1,", "3,").format(6)):
        monitor.update(6, x=4.0)
    monitor.update(7, x=4.0)
    monitor.update(11, x=4.0)
    assert monitor.samples == 5


@pytest.mark.parametrize("first", [True, False])
def test_first_sample_that_the_watermark_excludes_is_rejected(buffering, first):
    made, name = buffering
    monitor = made(lateness=9)
    if not first:
        monitor.update(10, x=4.0)
    monitor.watermark(5)
    if first:
        name = name.replace("1,", "0,")
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(5, x=4.0)
    assert str(error.value) == (
        f"{name.format(5)} is later than the lateness of 9 s allows: everything up to 5 s is final; "
        f"leave it out, or allow for more lateness"
    )
    monitor.update(6, x=5.0)
    assert monitor.interval(6).lower == 2.0


def test_first_sample_off_the_grid_is_irregular_even_when_it_is_too_late():
    monitor = rtamt.parse("x >= 3", period=1).monitor(verdict="interval", lateness=3)
    monitor.update(10, x=4.0)
    for time in (5.5, 8.5):
        with pytest.raises(rtamt.TraceError, match="expected 1 s"):
            monitor.update(time, x=4.0)
    monitor.update(7, x=4.0)
    assert monitor.samples == 2
