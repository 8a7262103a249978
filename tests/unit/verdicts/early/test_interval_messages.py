"""What monitors of bounds reject in both time domains, in the same words."""

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
