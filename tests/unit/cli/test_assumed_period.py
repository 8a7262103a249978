"""The period of 1 s that is assumed where nothing else is known: noted, or rejected."""

import json
from pathlib import Path

import pytest

SPEC = "always[0:2](x > 0)"
NOTE = "no column holds timestamps: the samples are taken to be 1 s apart"
STREAMED = "rtamt: note: stdin: the samples have no timestamps and are taken to be 1 s apart\n"
UNKNOWN = (
    "the first column 'Zeit' may hold the timestamps: its values increase, but not by 1 from row to row; choose it "
    "with time='Zeit', on the command line --time-column Zeit, or give the period of the samples, such as period='1s', "
    "on the command line --period 1s"
)


@pytest.fixture(autouse=True)
def recordings(write):
    write("zeit.csv", "Zeit,x\n0,1\n0.1,2\n0.2,-1\n0.3,4\n")
    write("seq.csv", "seq,x\n5,1\n6,2\n7,-1\n8,4\n")


@pytest.mark.parametrize(
    "command", [("check",), ("check", "--early"), ("explain",), ("plot", "-o", "p.svg")], ids=" ".join
)
def test_commands_reject_a_first_column_that_may_hold_the_timestamps(run, command):
    name, *options = command
    answer = run(name, SPEC, "zeit.csv", *options)
    assert (answer.code, answer.err) == (2, f"rtamt: zeit.csv: {UNKNOWN}\n")


@pytest.mark.parametrize("options", [("--period", "1s"), ("--time-column", "")])
def test_a_period_or_no_column_at_all_is_a_choice_without_a_note(run, options):
    answer = run("check", SPEC, "zeit.csv", "--json", *options)
    row = json.loads(answer.out)
    assert (answer.code, row["robustness"], row["period"], "notes" in row) == (1, -1, 1, False)


def test_the_column_is_a_choice(run):
    answer = run("check", "always[0:200ms](x > 0)", "zeit.csv", "--time-column", "Zeit", "--json")
    assert json.loads(answer.out)["period"] == 0.1


@pytest.mark.parametrize("early", [(), ("--early",)])
def test_the_assumed_period_is_noted_once_beside_bounds_in_time(run, write, early):
    write("a.stl", "always[0:2](x > 0)")
    write("b.stl", "always[0:1](x > -3)")
    answer = run("check", "a.stl", "b.stl", "seq.csv", *early)
    assert answer.code == 1
    assert answer.out.count(f"note: seq.csv: {NOTE}\n") == 1
    assert NOTE not in run("check", "always(x > 0)", "seq.csv", *early).out


def test_the_assumed_period_is_noted_where_a_file_is_read_in_chunks(run, monkeypatch):
    monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)
    assert json.loads(run("check", SPEC, "seq.csv", "--json").out)["notes"] == [NOTE]
    assert run("check", SPEC, "zeit.csv").err == f"rtamt: zeit.csv: {UNKNOWN}\n"


def test_a_requirement_is_rejected_whether_or_not_another_reads_the_first_column(run, write):
    write("a.stl", "always(Zeit >= 0)")
    write("b.stl", "always(x > -3)")
    answer = run("check", "a.stl", "b.stl", "zeit.csv", "--json")
    first, second = map(json.loads, answer.out.splitlines())
    assert (answer.code, first["satisfied"], second["error"]) == (2, True, f"zeit.csv: {UNKNOWN}")


@pytest.mark.parametrize("early", [(), ("--early",)])
def test_a_requirement_that_reads_the_first_column_does_not_decide_for_the_others_of_its_file(
    run, write, early, monkeypatch
):
    write("two.stl", "require A: always(Zeit >= 0)\nrequire B: always[0:2](x > 0)")
    for large in (None, 0):
        if large is not None:
            monkeypatch.setattr("rtamt.cli.runner.LARGE", large)
        answer = run("check", "two.stl", "zeit.csv", "--json", *early)
        first, second = map(json.loads, answer.out.splitlines())
        assert (answer.code, first["satisfied"], second["error"]) == (2, True, f"zeit.csv: {UNKNOWN}")
    assert run("explain", "two.stl", "zeit.csv").err == f"rtamt: zeit.csv: {UNKNOWN}\n"


@pytest.mark.parametrize("formula", ["always(rate(x) < 9)", "always(duration(x > 0) < 9)", "integral(x) < 9"])
def test_the_assumed_period_is_noted_where_a_value_counts_seconds(run, formula):
    assert json.loads(run("check", formula, "seq.csv", "--json").out)["notes"] == [NOTE]
    assert "notes" not in json.loads(run("check", "count(x > 0) < 9", "seq.csv", "--json").out)


def test_every_command_about_one_recording_notes_the_assumed_period(run):
    assert run("explain", SPEC, "seq.csv").out.endswith(f"\n\nnote: seq.csv: {NOTE}\n")
    assert json.loads(run("explain", SPEC, "seq.csv", "--json").out)["notes"] == [NOTE]
    assert run("plot", SPEC, "seq.csv", "-o", "p.svg").out.endswith(f"\nnote: seq.csv: {NOTE}\n")
    assert run("export", SPEC, "seq.csv", "-o", "p.mcap").out.endswith(f"\nnote: seq.csv: {NOTE}\n")
    run("report", SPEC, "seq.csv", "-o", "p.html")
    assert NOTE in Path("p.html").read_text()


def test_explain_notes_what_was_left_out_of_a_recording(run, write):
    write("nan.csv", "time,x\n0,1\n1,nan\n2,4\n")
    answer = run("explain", "always(x > 0)", "nan.csv", "--time", "dense", "--skip-nan", "x")
    assert answer.out.endswith("\n\nnote: nan.csv: left out, NaN: 1 sample of x, the first at 1 s\n")


@pytest.mark.parametrize("more", [(), ("--keep-going",), ("--verdict", "eager")], ids=" ".join)
def test_a_monitor_rejects_a_first_column_at_the_first_sample_that_shows_timestamps(run, more):
    answer = run("monitor", "once[0:2](x > 0)", *more, stdin="Zeit,x\n0,1\n1,2\n1.1,3\n1.2,4\n")
    assert (answer.code, answer.err) == (2, f"{STREAMED}rtamt: stdin, line 4: {UNKNOWN}\n")
    assert answer.out.count("\n") == 2
    for option in (("--period", "1s"), ("--time-column", "")):
        answer = run("monitor", "once[0:2](x > 0)", *option, stdin="Zeit,x\n0,1\n0.1,2\n")
        assert (answer.code, answer.err) == (0, "")
    assert run("monitor", "once(x > 0)", stdin="Zeit,x\n0,1\n0.1,2\n").code == 0


@pytest.mark.parametrize(
    "rows", ["5,1\n6,2\n", "5,1\n4,2\n9,3\n", "a,1\nb,2\n", ",1\n1,2\n3,4\n", "0,1\n0,2\n"]
)
def test_a_first_column_that_counts_or_does_not_increase_has_a_note_only(run, rows):
    answer = run("monitor", SPEC, stdin=f"first,x\n{rows}")
    assert (answer.code, answer.err) == (0, STREAMED)


def test_the_units_in_a_name_show_timestamps_at_the_first_sample_of_a_stream(run):
    answer = run("monitor", SPEC, stdin="tick_us,x\n0,1\n1,2\n")
    assert (answer.code, answer.out) == (2, "")
    assert "stdin, line 2: the first column 'tick_us' may hold the timestamps" in answer.err


@pytest.mark.parametrize("stdin", ["seq,x\n0,1\n1,2\n", '{"x": 1}\n{"x": 2}\n'], ids=["CSV", "JSON"])
def test_a_monitor_notes_once_that_the_samples_of_a_stream_have_no_timestamps(run, stdin):
    assert run("monitor", SPEC, stdin=stdin).err == STREAMED
    assert run("monitor", SPEC, "--period", "1s", stdin=stdin).err == ""
    assert run("monitor", "once(x > 0)", stdin=stdin).err == ""


def test_a_monitor_of_samples_with_timestamps_has_no_note(run):
    assert run("monitor", SPEC, stdin="time,x\n0,1\n1,2\n").err == ""
