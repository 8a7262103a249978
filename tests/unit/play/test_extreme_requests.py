"""Requests with numbers beyond all use, and values of other types: each is rejected, or answered, in one sentence."""

import json
import math

import pytest

from rtamt.play.messages import MessageError
from rtamt.play.request_handler import RequestHandler
from rtamt.play.worker import reply

MESSAGE = {
    "text": "always(x >= 3)",
    "time": "discrete",
    "period": "1s",
    "duration": 30,
    "signals": {"x": {"points": [[0, 4], [10, 5]], "hold": True}},
}
VALUES = [
    None,
    True,
    -1,
    0.5,
    1e308,
    -1e308,
    5e-324,
    math.nan,
    math.inf,
    10**400,
    2**64,
    "",
    "x",
    [],
    [0, 0],
    [[0]],
    {},
]


@pytest.fixture(scope="module")
def handler():
    return RequestHandler()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    "field", [*MESSAGE, "recording", "resample", "focus", "width", "view", "at", "points", "point", "hold"]
)
def test_no_value_of_a_field_is_an_internal_error(handler, field, time):
    for value in VALUES:
        message = {**MESSAGE, "time": time, field: value}
        if field in {"points", "point", "hold"}:
            signal = {
                "points": [[0, 4], [1, value]] if field == "point" else MESSAGE["signals"]["x"]["points"]
            }
            message["signals"] = {"x": {**signal, field: value}}
        for kind in ("evaluate", "redraw", "replay", "redraw_replay", "cursor"):
            line = json.dumps({"kind": kind, "message": message}).encode()
            assert b"internal error" not in reply(handler, line), (kind, value)


@pytest.mark.parametrize("wanted", [[0, 0], {}, None, 1, True, math.nan, "trace", ["witness"]])
def test_what_is_wanted_may_have_no_hash(handler, wanted):
    with pytest.raises(MessageError) as error:
        handler.answer("find_trace", {**MESSAGE, "wanted": wanted})
    assert str(error.value) == "'wanted' must be witness or counterexample"


@pytest.mark.parametrize("kind", ["evaluate", "redraw", "replay", "redraw_replay", "cursor"])
@pytest.mark.parametrize("hold", [True, False])
def test_durations_whose_samples_no_integer_counts_are_answers(handler, kind, hold):
    signals = {"x": {"points": [[0, 1]], "hold": hold}}
    message = {**MESSAGE, "text": "sample 100ms\nx >= 0", "duration": 1e308, "signals": signals}
    assert handler.answer(kind, message)["error"]["message"] == (
        "more than 10^15 samples are too many to draw, at most 200000: choose a longer period, a shorter duration, or "
        "load a recording"
    )


@pytest.mark.filterwarnings("error")
def test_points_at_huge_times_cause_no_overflow_warning(handler):
    signals = {"x": {"points": [[-1.7e308, 4], [1, 5], [1e308, 0]], "hold": True}}
    message = {**MESSAGE, "text": "always(x >= 3)", "time": "dense", "signals": signals}
    answer = handler.answer("evaluate", message)
    assert (answer["error"], answer["interval"]) == (None, [1, 1])


def test_a_replay_longer_than_early_monitors_take_is_an_answer(handler):
    signals = {"x": {"points": [[0, 4], [1, 5]], "hold": True}}
    message = {
        **MESSAGE,
        "text": "always(x >= 3)",
        "time": "dense",
        "duration": 2_000_000_000,
        "signals": signals,
    }
    assert "spans more than 2^60 ticks" in handler.answer("replay", message)["error"]["message"]
