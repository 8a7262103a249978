"""Messages in, data out: evaluation, recordings, online replay, questions."""

import json
import math

import pytest

import rtamt
from rtamt.play.messages import MOST_POINTS, MessageError
from rtamt.play.request_handler import RequestHandler

TEXT = "always(req >= 3 -> eventually[0:5](gnt >= 3))"
REQ = [[0, 0], [4, 6], [6, 0], [18, 5], [21, 0]]
GNT = [[0, 0], [7, 4], [10, 0], [26, 4], [28, 0]]
MESSAGE = {
    "text": TEXT,
    "time": "discrete",
    "period": "1s",
    "duration": 30,
    "width": 800,
    "signals": {"req": {"points": REQ, "hold": True}, "gnt": {"points": GNT, "hold": True}},
}


@pytest.fixture(scope="module")
def handler():
    return RequestHandler()


def held(points, count):
    return [next(value for time, value in reversed(points) if time <= t) for t in range(count)]


def test_the_answer_is_that_of_evaluate_and_explain(handler):
    result = rtamt.parse(TEXT).evaluate({"req": held(REQ, 31), "gnt": held(GNT, 31)}, period=1)
    answer = handler.answer("evaluate", MESSAGE)
    assert answer["error"] is None
    assert (answer["verdict"], answer["interval"]) == ("violated", [result.robustness] * 2)
    assert answer["robustness"]["y"] == result.signal.values.tolist()
    assert answer["first"] == result.explain().first_violation == 18
    assert [each["text"] for each in answer["explanation"]["causes"]] == list(result.explain().causes)
    assert answer["explanation"]["because"] == {"req": [[18, 18]], "gnt": [[18, 23]]}
    assert answer["fails"] == [[18, 21]]
    assert answer["thresholds"] == {"req": [3], "gnt": [3]}


def test_a_period_that_the_text_declares_replaces_that_of_the_page(handler):
    text = "sample 500ms\nalways[0:500ms](req <= 5)"
    answer = handler.answer("evaluate", {**MESSAGE, "text": text, "duration": 4})
    assert (answer["error"], answer["declared"], answer["period"], answer["samples"]) == (None, True, 0.5, 9)
    assert (answer["verdict"], answer["step"]) == ("satisfied", 0.5)
    assert handler.answer("evaluate", MESSAGE)["declared"] is False


def test_dense_time_has_the_points_themselves(handler):
    message = {**MESSAGE, "time": "dense", "signals": {**MESSAGE["signals"]}}
    message["signals"]["gnt"] = {"points": [[0, 0], [7.25, 4]], "hold": True}
    answer = handler.answer("evaluate", message)
    expected = rtamt.parse(TEXT, time="dense").evaluate(
        {"req": [*REQ, [30, 0]], "gnt": [[0, 0], [7.25, 4], [30, 4]]}
    )
    assert answer["dense"] is True
    assert answer["interval"] == [expected.robustness] * 2
    assert answer["lines"][1]["x"] == [0, 7.25, 30]


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("always(x >= )", "expected an operand after '>=', got ')'", (12, 13)),
        ("", "write a formula, such as always(x >= 3)", (None, None)),
        (
            "always[0:2.5](req >= 3)",
            "The operator bound must be a multiple of the sampling period: 2.5 s is not a whole number of periods of "
            "1 s; change the bound or the period",
            (6, 13),
        ),
    ],
)
def test_a_mistake_in_the_text_is_an_answer_with_its_place(handler, text, message, place):
    error = handler.answer("evaluate", {**MESSAGE, "text": text})["error"]
    assert error == {"message": message, "start": place[0], "end": place[1]}


@pytest.mark.parametrize(("time", "fails"), [("discrete", [[0, 3], [5, 6]]), ("dense", [[0, 3], [5, 5]])])
def test_instants_fail_where_the_formula_does_not_hold_even_with_robustness_0(handler, time, fails):
    signals = {"x": {"points": [[0, 3], [3, 4], [5, 3]], "hold": True}}
    message = {**MESSAGE, "text": "always(x > 3)", "time": time, "duration": 5, "signals": signals}
    answer = handler.answer("evaluate", message)
    assert (answer["verdict"], answer["first"], answer["interval"]) == ("violated", 0, [0, 0])
    assert answer["fails"] == fails


def test_variables_without_a_signal_are_listed(handler):
    answer = handler.answer("evaluate", {**MESSAGE, "text": "always(req >= speed)"})
    assert (answer["variables"], answer["missing"]) == (["req", "speed"], ["speed"])
    assert "verdict" not in answer


def test_of_several_requirements_the_first_violated_one_is_explained_unless_another_is_wanted(handler):
    text = "require LOW: always(req <= 9); require HIGH: always(gnt >= 1)"
    answer = handler.answer("evaluate", {**MESSAGE, "text": text})
    assert [(each["name"], each["verdict"]) for each in answer["requirements"]] == [
        ("LOW", "satisfied"),
        ("HIGH", "violated"),
    ]
    assert answer["focus"] == "HIGH"
    assert handler.answer("evaluate", {**MESSAGE, "text": text, "focus": "LOW"})["verdict"] == "satisfied"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"text": 5}, "'text' must be a text"),
        ({"time": "lunar"}, "'time' is 'lunar'; it must be one of discrete, dense"),
        ({"duration": math.nan}, "'duration' must be a finite number"),
        ({"duration": True}, "'duration' must be a finite number"),
        ({"signals": []}, "'signals' must map names to drawn signals"),
        ({"signals": {"x": {}}}, "the signal 'x' must have a list of points"),
        (
            {"signals": {"x": {"points": []}}},
            f"the signal 'x' has 0 points; give 1 to {MOST_POINTS}",
        ),
        (
            {"signals": {"x": {"points": [[1]]}}},
            "a point of the signal 'x' must be a pair of time and value",
        ),
        (
            {"signals": {"x": {"points": [[1, 0], [1, 0]]}}},
            "the points of the signal 'x' must be in the order of time",
        ),
        ({"recording": "../a.csv"}, "'recording' must be a number that the server gave, or null"),
        ({"resample": "cubic"}, "'resample' is 'cubic'; it must be hold, linear or empty"),
        ({"focus": 3}, "'focus' must be the name of a requirement, or null"),
        ({"view": 3}, "'view' must be two times, or null"),
        ({"view": [1, "2"]}, "'view' must be a finite number"),
        ({"view": [2, 2]}, "'view' must begin before it ends"),
        ({"text": "x" * 200_001}, "'text' has 200001 characters; at most 200000 are allowed"),
    ],
)
def test_malformed_messages_are_one_sentence(handler, change, sentence):
    with pytest.raises(MessageError) as error:
        handler.answer("evaluate", {**MESSAGE, **change})
    assert str(error.value) == sentence


def test_unusable_settings_are_answers(handler):
    assert "'soon'" in handler.answer("evaluate", {**MESSAGE, "period": "soon"})["error"]["message"]
    assert handler.answer("evaluate", {**MESSAGE, "duration": 1e9})["error"]["message"] == (
        "1000000001 samples are too many to draw, at most 200000: choose a longer period, a shorter duration, or "
        "load a recording"
    )
    assert handler.answer("evaluate", {**MESSAGE, "recording": 7})["error"]["message"] == (
        "the recording is no longer here: load it again"
    )


def test_texts_read_no_file_of_the_machine(tmp_path):
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / "near.stl").write_text("const float limit = 3;")
    (tmp_path / "far.stl").write_text("const float limit = 3;")
    text = 'import "{}"\nalways(req >= limit)'
    alone, with_folder = RequestHandler(), RequestHandler(str(tmp_path / "given"))
    assert (
        "no file 'near.stl'"
        in alone.answer("evaluate", {**MESSAGE, "text": text.format("near.stl")})["error"]["message"]
    )
    assert with_folder.answer("evaluate", {**MESSAGE, "text": text.format("near.stl")})["error"] is None
    for path in ("../far.stl", str(tmp_path / "far.stl"), "other.stl"):
        error = with_folder.answer("evaluate", {**MESSAGE, "text": text.format(path)})["error"]
        assert error is not None
        assert str(tmp_path / "given") not in error["message"]


def test_a_recording_is_evaluated_whole_and_drawn_reduced(handler, tmp_path):
    values = [math.sin(i / 50) for i in range(10_000)]
    values[5000] = -9
    path = tmp_path / "secret folder" / "1.csv"
    path.parent.mkdir()
    path.write_text("time,x [m/s]\n" + "".join(f"{i / 10},{x}\n" for i, x in enumerate(values)))
    file = {"number": 1, "path": str(path), "name": "drive.csv"}
    summary = handler.answer("recording", {}, file)
    assert (summary["name"], summary["samples"], summary["signals"]) == (
        "drive.csv",
        10_000,
        [{"name": "x", "unit": "m/s"}],
    )
    message = {
        **MESSAGE,
        "text": "always(x >= -2)",
        "period": "",
        "signals": {},
        "recording": 1,
        "width": 100,
    }
    answer = handler.answer("evaluate", message, file)
    assert (answer["interval"], answer["first"]) == ([-7, -7], 500)
    (line,) = answer["lines"]
    assert line["points"] == 10_000
    assert len(line["x"]) <= 200
    assert (min(line["y"]), line["x"][line["y"].index(-9)]) == (-9, 500)
    assert "secret folder" not in json.dumps([summary, answer])
    missing = handler.answer("evaluate", {**message, "text": "always(y >= 0)"}, file)
    assert "secret folder" not in missing["error"]["message"]
    assert "'y'" in missing["error"]["message"]


@pytest.mark.parametrize("kind", ["evaluate", "replay"])
def test_the_period_of_a_recording_is_that_of_the_horizon(handler, tmp_path, kind):
    path = tmp_path / "1.csv"
    path.write_text("time,x\n" + "".join(f"{i / 10},{i}\n" for i in range(20)))
    message = {**MESSAGE, "text": "always(rate(x) < 20 -> eventually[0:500ms](x >= 3))", "period": ""}
    message |= {"signals": {}, "recording": 12}
    answer = handler.answer(kind, message, {"number": 12, "path": str(path), "name": "a.csv"})
    assert answer["error"] is None
    if kind == "evaluate":
        assert answer["verdict"] == "satisfied"


def test_an_unreadable_recording_is_a_sentence_without_its_folder(handler, tmp_path):
    path = tmp_path / "9.csv"
    path.write_text("")
    answer = handler.answer("recording", {}, {"number": 9, "path": str(path), "name": "empty.csv"})
    assert "empty.csv" in answer["error"]["message"]
    assert str(tmp_path) not in answer["error"]["message"]


# In dense time no sample comes between 21 s and 26 s.
@pytest.mark.parametrize(("time", "decided_at"), [("discrete", 23), ("dense", 26)])
def test_the_replay_is_what_monitors_report(handler, time, decided_at):
    answer = handler.answer("replay", {**MESSAGE, "time": time})
    assert answer["error"] is None
    assert answer["formula"] == "req >= 3 -> eventually[0:5](gnt >= 3)"
    assert answer["bounds"]["decided"] == decided_at
    assert (answer["bounds"]["lower"][0], answer["bounds"]["upper"][-1]) == ("-Infinity", -2)
    runs = {begin: (good, decided) for begin, _, good, decided in answer["runs"]}
    assert runs[18] == (False, decided_at)
    assert runs[4][0] is True
    for begin, end, _, decided in answer["runs"]:
        assert begin < end
        assert decided is None or 0 <= decided <= 30


def test_in_discrete_time_each_verdict_is_that_of_the_eager_monitor(handler):
    monitor = rtamt.parse("req >= 3 -> eventually[0:5](gnt >= 3)").monitor(verdict="eager")
    expected = {}
    for t, (req, gnt) in enumerate(zip(held(REQ, 31), held(GNT, 31), strict=True)):
        expected |= {v.time: (v.satisfied, v.decided_at) for v in monitor.update(t, req=req, gnt=gnt)}
    runs = handler.answer("replay", MESSAGE)["runs"]
    assert len(runs) == 31
    assert {begin: (good, at) for begin, _, good, at in runs if at is not None} == expected


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_sample_outside_its_declared_range_ended_the_replay(handler, time):
    message = {**MESSAGE, "time": time}
    declared = {**message, "text": f"input float req in [0, 5]  input float gnt in [0, 3.5]  {TEXT}"}
    for kind, at in (("replay", {}), ("cursor", {"at": 20})):
        assert handler.answer(kind, {**declared, **at}) == handler.answer(kind, {**message, **at})


def test_pending_instants_have_intervals_that_contain_their_value(handler):
    final = rtamt.parse("req >= 3 -> eventually[0:5](gnt >= 3)").evaluate(
        {"req": held(REQ, 31), "gnt": held(GNT, 31)}, period=1
    )
    pending = handler.answer("cursor", {**MESSAGE, "at": 20})["pending"]
    assert [time for time, _, _ in pending] == [16, 17, 18, 19, 20]
    for time, low, high in pending:
        assert float(low) <= final.signal.values[int(time)] <= float(high)


def test_at_the_cursor_the_bounds_and_the_number_of_open_instants_are_those_of_the_replay(handler):
    replay = handler.answer("replay", MESSAGE)
    for at in (-1, 0, 3.5, 20, 30):
        known = handler.answer("cursor", {**MESSAGE, "at": at})
        bounds = [
            list(pair)
            for x, *pair in zip(*(replay["bounds"][name] for name in ("x", "lower", "upper")), strict=True)
            if x <= at
        ]
        assert known["bounds"] == (bounds[-1] if bounds else None)
        assert known["open"] == sum(
            begin <= at < (30 if decided is None else decided) for begin, _, _, decided in replay["runs"]
        )


VIEW = {**MESSAGE, "text": "always(x <= 8)", "period": "10ms", "duration": 100, "width": 50}
VIEW["signals"] = {"x": {"points": [[k / 2, k % 10] for k in range(200)], "hold": False}}


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_part_of_the_time_is_drawn_in_full_detail(handler, time):
    message = {**VIEW, "time": time}
    whole = handler.answer("evaluate", message)
    near = handler.answer("redraw", {**message, "view": [20.005, 20.205]})["near"]
    assert (whole["error"], whole["near"], near["view"]) == (None, None, (20.005, 20.205))
    (line,) = near["lines"]
    assert line["x"] == pytest.approx([20 + k / 100 for k in range(22)])  # one more at each side
    assert line["points"] == whole["lines"][0]["points"]
    assert len(whole["lines"][0]["x"]) <= 2 * VIEW["width"]
    for begin, end in handler.answer("redraw", {**message, "view": [40, 60]})["near"]["fails"]:
        assert end >= 40
        assert begin <= 60
        assert [begin, end] in whole["fails"]
    # An evaluation has both.
    assert handler.answer("evaluate", {**message, "view": [20.005, 20.205]}) == {**whole, "near": near}


def test_a_part_of_the_replay_is_drawn_in_full_detail(handler):
    whole = handler.answer("replay", VIEW)
    near = handler.answer("redraw_replay", {**VIEW, "view": [20, 20.2]})["near"]
    assert [begin for begin, *_ in near["runs"]] == pytest.approx([19.99 + k / 100 for k in range(22)])
    assert near["bounds"]["x"] == pytest.approx([19.99 + k / 100 for k in range(23)])
    assert near["bounds"]["decided"] == whole["bounds"]["decided"] == 4.01
    assert len(whole["runs"]) <= VIEW["width"]


def test_what_is_drawn_follows_the_text_and_the_signals(handler):
    for text in ("always(x <= 8)", "always(x <= 7)"):
        message = {**VIEW, "text": text}
        view = {**message, "view": [0, 1]}
        near = handler.answer("redraw", view)["near"]
        assert near["fails"] == []
        assert near["robustness"]["y"][0] == pytest.approx(8 - 9 - (text[-2] == "7"))
        assert handler.answer("redraw_replay", view)["near"]["bounds"]["lower"][-1] == "-Infinity"
    wrong = {**VIEW, "text": "always(x <= )"}
    for kind in ("redraw", "redraw_replay", "cursor"):
        assert handler.answer(kind, wrong)["error"]["message"] == "expected an operand after '<=', got ')'"


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_groups_and_enumerations_of_a_recording_are_evaluated_and_replayed(handler, tmp_path, time):
    path = tmp_path / "traffic.csv"
    path.write_text(
        "time,ego.x,car_1.x,car_7.x,mode\n0,1,20,,AUTO\n1,2,20,30,MANUAL\n2,3,,7,AUTO\n3,3,,7,AUTO\n"
    )
    file = {"number": 20, "path": str(path), "name": path.name}
    texts = {
        'group cars = "car_*"; always forall v in cars: v.x - ego.x > 5': ("violated", 2),
        "enum Mode { AUTO, MANUAL } input Mode mode; always(mode == AUTO)": ("violated", 1),
    }
    for text, (verdict, first) in texts.items():
        message = {**MESSAGE, "text": text, "time": time, "period": "", "recording": 20, "at": 2}
        answer = handler.answer("evaluate", message, file)
        assert (answer["error"], answer["verdict"], answer["first"]) == (None, verdict, first)
        assert answer["fails"][0][0] == first
        assert handler.answer("replay", message, file)["bounds"]["decided"] == first
        assert handler.answer("cursor", message, file)["pending"] == []


def test_missing_samples_leave_bounds_and_maybe_no_verdict(handler, tmp_path):
    path = tmp_path / "gaps.csv"
    path.write_text("time,x,y\n0,5,1\n1,,1\n2,4,1\n")
    file = {"number": 21, "path": str(path), "name": path.name}
    message = {**MESSAGE, "text": "eventually(x >= 3)", "period": "", "recording": 21}
    answer = handler.answer("evaluate", message, file)
    assert (answer["error"], answer["verdict"], answer["interval"]) == (None, "satisfied", [2, "Infinity"])
    held = handler.answer("evaluate", {**message, "period": "1s", "resample": "hold"}, file)
    assert (held["error"], held["verdict"], held["interval"]) == (None, "satisfied", [2, 2])
    assert handler.answer("evaluate", {**message, "resample": "hold"}, file)["error"]["message"] == (
        "to put the signals on one time base, give a period"
    )


def test_long_recordings_are_not_replayed(handler):
    message = {**MESSAGE, "duration": 20_001}
    assert handler.answer("evaluate", message)["error"] is None
    assert handler.answer("replay", message)["error"]["message"] == (
        "a recording of more than 20000 samples is not replayed; it is evaluated as a whole"
    )


@pytest.mark.parametrize(("wanted", "verdict"), [("witness", "satisfied"), ("counterexample", "violated")])
def test_a_found_trace_has_the_wanted_verdict_when_it_is_drawn(handler, wanted, verdict):
    message = {
        **MESSAGE,
        "text": "always[0:3](req >= 3 -> eventually[0:2](gnt >= 3)) and eventually[0:3](req >= 5)",
    }
    found = handler.answer("find_trace", {**message, "wanted": wanted})
    assert found["error"] is None
    drawn = {**message, "signals": found["signals"], "duration": found["duration"]}
    assert handler.answer("evaluate", drawn)["verdict"] == verdict


def test_what_no_trace_violates_has_no_counterexample(handler):
    found = handler.answer(
        "find_trace", {**MESSAGE, "text": "always[0:3](req >= 3 or req <= 3)", "wanted": "counterexample"}
    )
    assert found["signals"] is None
    assert "always holds" in found["sentence"]
    with pytest.raises(MessageError, match="'wanted' must be witness or counterexample"):
        handler.answer("find_trace", {**MESSAGE, "wanted": "money"})
