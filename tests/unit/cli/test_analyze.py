"""``rtamt analyze`` and ``rtamt diff``."""

import json

SPEC = """
sample 1s
require A: always(x > 3 -> eventually[0:2](y > 3))
require B: always(x > 5 -> eventually[0:2](y > 3))
"""
SOUND = "sample 1s\nrequire A: always(x > 3 -> eventually[0:2](y > 3))\n"
BOUNDED = "sample 1s\nrequire A: eventually[0:2](y > 3)\n"


def test_files_and_folders_are_analysed_and_a_finding_is_exit_code_one(run, write, tmp_path):
    write("sound.stl", SOUND)
    assert run("analyze", "sound.stl", "--samples", "9") == (
        0,
        "sound.stl: traces up to 9 samples of 1 s, 3 answers\n"
        "  note: A has unbounded operators: traces longer than 9 samples are not covered\n",
        "",
    )
    (tmp_path / "specs" / "inner").mkdir(parents=True)
    write("specs/inner/spec.stl", SPEC)
    write("specs/bounded.stl", BOUNDED)
    answer = run("analyze", "specs", "--samples", "9")
    assert answer.code == 1
    assert answer.out == (
        "specs/bounded.stl: traces up to 9 samples of 1 s, 2 answers\n"
        "specs/inner/spec.stl: traces up to 9 samples of 1 s, 9 answers\n"
        "  finding: B: it is redundant, because A implies it: no counterexample up to 9 samples\n"
        "  note: A and B have unbounded operators: traces longer than 9 samples are not covered\n"
    )


def test_one_sample_and_one_answer_are_not_plural(run, write):
    write("old.stl", "require A: always(x <= 1)\n")
    found = run("diff", "old.stl", "old.stl", "--samples", "1")
    assert found.out.splitlines()[0] == "old.stl -> old.stl: traces up to 1 sample of 1 s, 1 answer"


def test_json_has_every_answer_with_its_trace(run, write):
    write("spec.stl", SPEC)
    rows = [
        json.loads(line) for line in run("analyze", "spec.stl", "--samples", "9", "--json").out.splitlines()
    ]
    valid = next(row for row in rows if row.get("question") == "valid" and row["requirements"] == ["B"])
    assert (valid["holds"], valid["finding"], valid["confirmed"]) == (False, False, True)
    assert valid["margin"] >= 0.1
    assert set(valid["trace"]) == {"time", "x", "y"}
    assert rows[-1] == {
        "file": "spec.stl",
        "note": "A and B have unbounded operators: traces longer than 9 samples are not covered",
    }


def test_recordings_that_trigger_no_implication_are_a_finding(run, write):
    write("sound.stl", SOUND)
    write("quiet.csv", "time,x,y\n0,1,0\n1,2,0\n")
    answer = run("analyze", "sound.stl", "--samples", "9", "--recordings", "quiet.csv")
    assert answer.code == 1
    assert "A: it is vacuous on the given recordings: 'x > 3' is never true in 1 recording\n" in answer.out


def test_plots_of_the_traces_are_written(run, write, tmp_path):
    write("spec.stl", SPEC)
    run("analyze", "spec.stl", "--samples", "9", "--plot", "plots")
    drawn = {path.name for path in (tmp_path / "plots").iterdir()}
    assert "spec-A-valid-2.png" in drawn
    assert all((tmp_path / "plots" / name).read_bytes().startswith(b"\x89PNG") for name in drawn)


def test_what_cannot_be_analysed_is_exit_code_two(run, write, tmp_path):
    write("wrong.stl", "always(x >")
    write("sound.stl", SOUND)
    answer = run("analyze", "wrong.stl", "sound.stl", "--samples", "9")
    assert answer.code == 2
    assert answer.err.startswith("rtamt: wrong.stl: ")
    assert answer.out.startswith("sound.stl: ")
    assert run("analyze", "sound.stl", "--time", "dense") == (
        2,
        "",
        "rtamt: sound.stl: dense time is not covered by the analysis, which counts samples: read the specification in "
        "discrete time\n",
    )
    (tmp_path / "empty").mkdir()
    assert run("analyze", "empty").err == "rtamt: the folder 'empty' has no specification files (.stl)\n"


def test_versions_that_agree_and_versions_that_do_not(run, write):
    write(
        "old.stl",
        "require A: always(x > 3); require B: always(x < 9); require C: x > 0; require D: x > 1; "
        "require F: x*x > 3",
    )
    write(
        "new.stl",
        "require A: not eventually(x <= 3); require B: always(x <= 9); require D: x < 5; require E: x > 0; "
        "require F: x > 3",
    )
    answer = run("diff", "old.stl", "new.stl", "--samples", "9")
    assert answer.code == 1
    first, *findings, unanswered, unbounded = answer.out.splitlines()
    assert first == "old.stl -> new.stl: traces up to 9 samples of 1 s, 6 answers"
    assert [line.partition(" (margin")[0] for line in findings] == [
        "  finding: B: the new version is looser: a trace of 8 samples",
        "  finding: D: the new version is neither stricter nor looser: a trace of 8 samples",
        "  finding: E: it is only in the new version",
        "  finding: C: it is only in the old version",
    ]
    assert unanswered == (
        "  open: F: the formula was changed, and 'x * x' is not covered by the analysis: "
        "a product of two signals is nonlinear"
    )
    assert unbounded.startswith("  note: A and B have unbounded operators")
    assert run("diff", "old.stl", "old.stl", "--samples", "9").code == 0


def test_a_changed_requirement_that_is_not_covered_is_no_agreement(run):
    answer = run("diff", "always(x * y > 3)", "always(x * y > 4)")
    assert answer.code == 2
    assert (
        "  open: requirement_1: the formula was changed, and 'x * y' is not covered by the analysis"
        in answer.out
    )
    assert run("diff", "always(x * y > 3)", "always(x * y > 3)").code == 0


def test_a_file_of_which_nothing_is_covered_is_not_sound(run):
    answer = run("analyze", "always(x * y > 3)", "--samples", "9")
    assert answer.code == 2
    assert "'x * y' is not covered by the analysis: a product of two signals is nonlinear" in answer.out
    assert run("analyze", "require A: always(x * y > 3); require B: x > 3", "--samples", "9").code == 0
