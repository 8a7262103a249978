"""Requirements over one bag, each of which reads topics with other clocks: every one is as if it were alone."""

from __future__ import annotations

import json

import pytest
from rosbags.highlevel import AnyReader

import rtamt
from rtamt.cli import main
from rtamt.readers.message_fields import header_time
from tests.unit.readers.bags import Bag

START = 1_700_000_000
SIMULATED = "always(/x.value < 0 -> eventually[2s:3s](/x.value >= 0))"
RECORDED = "always(/y.data >= 0)"
#: Both in one file, in two files, and in a file with a third that reads both topics.
TOGETHER = {
    "file": [f"require A: {SIMULATED}\nrequire B: {RECORDED}\n"],
    "files": [f"require A: {SIMULATED}\n", f"require B: {RECORDED}\n"],
    "group": [
        f'group floats = "/*"\nrequire A: {SIMULATED}\nrequire B: {RECORDED}\n'
        "require G: always(forall f in floats: f.data >= 0)\n"
    ],
    "third": [
        f'require A: {SIMULATED}\nrequire B: {RECORDED}\nrequire C: always("/x.value" + "/y.data" >= 0)\n'
    ],
}


@pytest.fixture
def bag(tmp_path):
    """Simulated time runs evenly, and the recording has a pause of 19 s in it."""
    with Bag(tmp_path, "mcap") as made:
        for i, (recorded, value) in enumerate(zip([0, 1, 20, 21, 22, 23], [5, -1, 5, 5, 5, 5], strict=True)):
            made.stamped("/x", 1000 + i, value, late=START + recorded - 1000 - i)
        for i in range(24):
            made.plain("/y", START + i, 0.0)
    return str(made.path)


@pytest.mark.parametrize(
    "options",
    [
        ["--time", "dense"],
        ["--time", "dense", "--early"],
        ["--time", "dense", "--engine", "local"],
        ["--period", "500ms"],
        ["--period", "500ms", "--early"],
        ["--period", "500ms", "--engine", "local"],
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("texts", TOGETHER.values(), ids=TOGETHER)
def test_another_requirement_changed_the_times_and_the_verdict_of_a_requirement(
    tmp_path, capsys, bag, options, texts
):
    specs = []
    for number, text in enumerate(texts):
        specs.append(tmp_path / f"{number}.stl")
        specs[-1].write_text(text)
    main(["check", *map(str, specs), bag, "--json", *options])
    rows = {
        row["requirement"].split(": ")[-1]: row
        for row in map(json.loads, capsys.readouterr().out.splitlines())
    }
    assert (rows["A"]["satisfied"], rows["B"]["satisfied"]) == (True, True)
    if "C" in rows:  # by the times of recording: -1 from 1 s on
        assert (rows["C"]["satisfied"], rows["C"]["first_violation"]) == (False, START + 1)


def test_the_page_of_a_report_has_no_topics_that_would_change_the_clock(tmp_path, bag):
    page = tmp_path / "report.html"
    assert main(["check", SIMULATED, bag, "--time", "dense", "--html", str(page)]) == 0
    assert "/y.data" not in page.read_text()
    assert main(["check", RECORDED, bag, "--time", "dense", "--html", str(page)]) == 0
    assert "/x.value" in page.read_text()


@pytest.mark.parametrize("time", [["--time", "dense"], ["--period", "500ms"]], ids=" ".join)
@pytest.mark.parametrize(
    "text",
    [
        TOGETHER["file"][0],
        'group xs = "*x"\ngroup ys = "*y"\n'
        "require A: always(forall x in xs: x.value >= -1)\nrequire B: always(forall y in ys: y.data >= 0)\n",
    ],
    ids=["topics", "groups"],
)
def test_what_requirements_with_different_clocks_have_in_common_is_refused(tmp_path, capsys, bag, time, text):
    """The plot had the verdict of both by the times of recording, and the file was an internal error."""
    spec, plot, table = tmp_path / "a.stl", tmp_path / "a.svg", tmp_path / "a.csv"
    spec.write_text(text)
    assert main(["plot", str(spec), bag, "-o", str(plot), *time]) == 2
    assert capsys.readouterr().err == (
        f"rtamt: {bag}: the requirements read topics with different clocks, so that they have no plot in common; "
        "'rtamt report' plots each of them\n"
    )
    assert main(["check", str(spec), bag, "-o", str(table), *time]) == 2
    assert capsys.readouterr() == (
        "",
        f"rtamt: '{table}' cannot have the robustness of requirements that read topics with different clocks: write "
        "one file for each requirement\n",
    )
    assert not plot.exists()
    assert not table.exists()


def test_clocks_of_different_simulations_are_refused_too(tmp_path, capsys):
    """Stamps of another year than that of the recording are dates, as its own are."""
    with Bag(tmp_path, "mcap") as made:
        for i in range(3):
            made.stamped("/x", START - 10**8 + i, 1.0, late=10**8)
            made.plain("/y", START + i, 1.0)
    spec, table = tmp_path / "a.stl", tmp_path / "a.csv"
    spec.write_text("require A: always(/x.value >= 0)\nrequire B: always(/y.data >= 0)\n")
    assert main(["check", str(spec), str(made.path), "-o", str(table), "--time", "dense"]) == 2
    assert "requirements that read topics with different clocks" in capsys.readouterr().err
    assert not table.exists()


def test_a_plot_of_what_a_bag_has_needs_no_optional_topics(tmp_path, capsys, bag):
    spec, plot, table = tmp_path / "a.stl", tmp_path / "a.svg", tmp_path / "a.csv"
    spec.write_text(
        'optional input float z = "/z.data"\ninput float y = "/y.data"\n'
        "require A: always(z >= 0)\nrequire B: always(y >= 0)\n"
    )
    assert main(["plot", str(spec), bag, "-o", str(plot), "--time", "dense"]) == 0
    assert capsys.readouterr().err == f"rtamt: {spec}, {bag}: not checked: A: no '/z.data'\n"
    assert main(["check", str(spec), bag, "-o", str(table), "--time", "dense"]) == 0
    assert table.exists()


@pytest.mark.parametrize("early", [[], ["--early"]], ids=["whole", "early"])
def test_a_signal_that_is_nan_throughout_was_an_internal_error_of_early_checks(tmp_path, capsys, early):
    with Bag(tmp_path, "mcap") as made:
        for i in range(3):
            made.plain("/x", START + i, float("nan"))
            made.plain("/y", START + i, 1.0)
    text = "require A: always(/x.data >= 0)\nrequire B: always(/y.data >= 0)\n"
    assert (
        main(["check", text, str(made.path), "--json", "--period", "1s", "--skip-nan", "/x.data", *early])
        == 2
    )
    a, b = map(json.loads, capsys.readouterr().out.splitlines())
    assert a["error"].endswith("'/x.data' has no samples: give at least one")
    assert b["satisfied"]


def test_infinities_are_strings_where_many_recordings_are_checked(capsys, bag):
    for engine in ([], ["--engine", "local"]):
        main(["check", "always(/y.data >= 0 or true)", bag, "--json", "--time", "dense", *engine])
        assert json.loads(capsys.readouterr().out, parse_constant=pytest.fail)["robustness"] == "inf"


@pytest.mark.parametrize("engine", [[], ["--engine", "local"]], ids=["one", "many"])
def test_messages_are_sampled_every_period_also_where_many_recordings_are_checked(tmp_path, capsys, engine):
    """Message 20, the only violation, is between two samples."""
    with Bag(tmp_path, "mcap") as made:
        for i in range(200):
            made.stamped("/x", START + i / 10, -1.0 if i == 20 else 1.0)
    for period, code in (("105ms", 0), ("100ms", 1)):
        assert (
            main(["check", "always(/x.value >= 0)", str(made.path), "--json", "--period", period, *engine])
            == code
        )
        assert json.loads(capsys.readouterr().out)["robustness"] == (1 if code == 0 else -1)


@pytest.mark.parametrize("engine", [[], ["--engine", "local"]], ids=["one", "many"])
def test_messages_that_are_no_samples_need_a_period(tmp_path, capsys, engine):
    with Bag(tmp_path, "mcap") as made:
        for i in (0, 1, 5, 6):
            made.stamped("/x", START + i, 1.0)
    assert main(["check", "always(/x.value >= 0)", str(made.path), "--json", *engine]) == 2
    assert "choose a sampling period, such as --period 100ms" in json.loads(capsys.readouterr().out)["error"]


def test_fields_of_declared_messages_are_found_where_many_bags_are_checked(tmp_path, capsys, bag):
    text = "from std_msgs.msg import Float64\ninput Float64 v @ topic(v, /y)\nalways(v.data >= 1)\n"
    (tmp_path / "a.stl").write_text(text)
    for engine in ([], ["--engine", "local"]):
        assert main(["check", str(tmp_path / "a.stl"), bag, "--json", "--time", "dense", *engine]) == 1
        assert json.loads(capsys.readouterr().out)["robustness"] == -1


RECORDED_AT = {1000: 0, 1001: 1, 1002: 20, 1003: 21, 1004: 22, 1005: 23}


def recorded_in(path):
    """Return when the messages on each topic that the check added were recorded, by their stamps."""
    with AnyReader([path]) as reader:
        found = {}
        for connection, recorded, raw in reader.messages():
            if connection.topic.startswith("/rtamt"):
                stamp = header_time(reader.deserialize(raw, connection.msgtype))
                found.setdefault(connection.topic, {})[stamp / 1e9] = recorded / 1e9 - START
    return found


@pytest.mark.parametrize(
    "text",
    ["always(/x.value >= -1)", 'group floats = "*x"\nalways(forall f in floats: f.value >= -1)\n'],
    ids=["topic", "group"],
)
def test_results_in_simulated_time_had_that_time_for_the_time_of_their_recording(tmp_path, bag, text):
    spec, out = tmp_path / "a.stl", tmp_path / "out.mcap"
    spec.write_text(text)
    assert main(["check", str(spec), bag, "--quiet", "--period", "1s", "-o", str(out)]) == 0
    topics = {"/rtamt/robustness", "/rtamt/robustness/verdict"}
    assert recorded_in(out) == dict.fromkeys(topics, RECORDED_AT)
    trace = rtamt.read(out, columns=["/x.value", "/rtamt/robustness.value"])
    assert trace.losses == ()
    assert trace["/rtamt/robustness.value"].times.tolist() == trace["/x.value"].times.tolist()


def test_results_between_messages_in_simulated_time_are_recorded_between_them(tmp_path, bag):
    out = tmp_path / "out.mcap"
    assert main(["check", SIMULATED, bag, "--quiet", "--period", "500ms", "-o", str(out)]) == 0
    times = recorded_in(out)["/rtamt/robustness"]
    assert times == RECORDED_AT | {1000.5: 0.5, 1001.5: 10.5, 1002.5: 20.5, 1003.5: 21.5, 1004.5: 22.5}


@pytest.mark.parametrize(
    "text",
    [RECORDED, 'always("/x.value" + "/y.data" >= -1)', "always(/late.value >= 0)"],
    ids=["without headers", "both", "stamps of the clock of the recording"],
)
def test_results_in_the_time_of_the_recording_are_recorded_at_this_time(tmp_path, text):
    with Bag(tmp_path, "mcap") as made:
        for i in range(4):
            made.stamped("/x", 1000 + i, 0.0, late=START - 1000)
            made.stamped("/late", START + i, 0.0, late=1)
            made.plain("/y", START + i, 0.0)
    out = tmp_path / "out.mcap"
    assert main(["check", text, str(made.path), "--quiet", "--period", "1s", "-o", str(out)]) == 0
    assert recorded_in(out)["/rtamt/robustness"] == {START + i: i for i in range(4)}


def test_results_of_each_requirement_are_recorded_by_its_own_clock(tmp_path, bag):
    out, spec = tmp_path / "out.mcap", tmp_path / "a.stl"
    spec.write_text(TOGETHER["file"][0])
    assert main(["check", str(spec), bag, "--quiet", "--period", "1s", "-o", str(out)]) == 0
    a, b = (recorded_in(out)[f"/rtamt/{name}"] for name in "AB")
    assert a == RECORDED_AT
    assert b == {START + i: i for i in range(24)}


def test_a_whole_bag_has_one_clock_and_a_note(bag):
    trace = rtamt.read(bag)
    assert trace["/x.value"].times[0] == trace["/y.data"].times[0]
    (note,) = trace.losses
    assert note.startswith("/x: the timestamps in its headers are ")


@pytest.mark.parametrize("settings", [{"time": "dense"}, {"period": "500ms"}], ids=["dense", "discrete"])
def test_a_formula_was_evaluated_with_the_times_that_topics_it_does_not_read_gave_it(bag, settings):
    spec, trace = rtamt.parse(SIMULATED), rtamt.read(bag)
    message = (
        r"the times of '/x\.value' are those of its recording, because topics of \S+ that the formula does not read "
        r"have another clock: read the bag with columns=\['/x\.value'\], on the command line give this requirement "
        r"alone"
    )
    with pytest.raises(rtamt.TraceError, match=message):
        spec.evaluate(trace, **settings)
    with pytest.raises(rtamt.TraceError, match=message):
        rtamt.parse("/x.value >= -2").monitor(**settings).update_many(trace)
    both = rtamt.parse(f"require A: {SIMULATED}\nrequire B: {RECORDED}\n")
    with pytest.raises(rtamt.TraceError, match=message):
        both.evaluate(trace.resample("500ms"), **settings)
    with pytest.raises(rtamt.TraceError, match=message):
        rtamt.check_stream(both, [trace.resample("500ms")], **settings)
    mine = rtamt.read(bag, columns=["/x.value"])
    mine = mine if settings == {"time": "dense"} else mine.resample("500ms")
    assert spec.evaluate(mine, **settings).satisfied


@pytest.mark.parametrize("formula", ["always(/y.data >= 0)", "always(/x.value + /y.data >= -1)"])
def test_a_formula_that_reads_a_topic_with_the_clock_of_the_bag_takes_the_whole_bag(bag, formula):
    assert rtamt.parse(formula).evaluate(rtamt.read(bag), time="dense").satisfied
