"""``sample 100ms hold`` on the command line: files, streams, and options that replace it."""

import json

import pytest

SPEC = """\
input float x
input float y
sample 100ms hold for 500ms
require R: historically(x <= 3 -> once[0:100ms](y >= 1))
"""
LOG = "time,x,y\n0,1,0\n0.05,,1\n0.12,2,\n0.33,4,0\n0.6,1,1\n"
VALUES = [-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0]


@pytest.fixture(autouse=True)
def _files(write):
    write("spec.stl", SPEC)
    write("log.csv", LOG)


def rows(answer):
    return [json.loads(line) for line in answer.out.splitlines()]


def test_a_file_and_a_stream_have_the_same_samples(run):
    answer = run("check", "spec.stl", "log.csv", "--json", "-o", "out.csv")
    assert (answer.code, answer.err) == (1, "")
    (row,) = rows(answer)
    assert (row["samples"], row["period"], row["robustness"]) == (7, 0.1, -1.0)
    with open("out.csv", encoding="utf-8") as file:
        lines = [tuple(map(float, line.split(","))) for line in file.read().splitlines()[1:]]
    csv = rows(run("monitor", "spec.stl", stdin=LOG))
    assert [(row["time"], row["robustness"]) for row in csv] == lines
    objects = "".join(
        json.dumps({k: v for k, v in {"time": t, "x": x, "y": y}.items() if v is not None}) + "\n"
        for t, x, y in [(0, 1, 0), (0.05, None, 1), (0.12, 2, None), (0.33, 4, 0), (0.6, 1, 1)]
    )
    assert rows(run("monitor", "spec.stl", stdin=objects)) == csv
    bounds = rows(run("monitor", "spec.stl", "--verdict", "eager", stdin=LOG))
    assert [row["satisfied"] for row in bounds] == [value > 0 for _, value in lines]


def test_several_requirements_and_reports(run, write):
    write("two.stl", SPEC + "require S: always(x <= 3)\n")
    answer = run("check", "two.stl", "log.csv", "--json", "--early", "--junit", "junit.xml")
    assert [(row["requirement"], row["satisfied"]) for row in rows(answer)] == [("R", False), ("S", False)]
    whole = run("check", "two.stl", "log.csv", "--json", "--junit", "junit.xml")
    assert [(row["requirement"], row["robustness"]) for row in rows(whole)] == [("R", -1.0), ("S", -1.0)]
    assert run("report", "two.stl", "log.csv", "-o", "page.html").code == 1
    assert "sample 100ms hold for 500ms" in run("info", "two.stl").out


@pytest.mark.parametrize(
    ("options", "code", "samples", "message"),
    [
        (["--period", "50ms"], 1, 13, "--period 50ms replaces that of 'sample 100ms hold for 500ms'"),
        (["--resample", "50ms"], 1, 13, "--resample 50ms replaces 'sample 100ms hold for 500ms'"),
        (["--hold-for", "1s"], 1, 7, "--hold-for 1s replaces the limit of 'sample 100ms hold for 500ms'"),
        (
            ["--hold-for", "100ms"],
            2,
            None,
            "--hold-for 100ms replaces the limit of 'sample 100ms hold for 500ms'",
        ),
        (["--how", "linear"], 1, 7, "--how linear replaces 'hold' of 'sample 100ms hold for 500ms'"),
        (["--period", "100ms", "--hold-for", "500ms"], 1, 7, ""),
    ],
)
def test_options_replace_the_rule_and_say_so(run, options, code, samples, message):
    answer = run("check", "spec.stl", "log.csv", "--json", *options)
    assert answer.code == code
    assert (f"rtamt: {message} in the specification\n" if message else "") in answer.err
    assert answer.err.count("replaces") == bool(message)
    if samples is not None:
        assert rows(answer)[0]["samples"] == samples


def test_a_value_that_is_too_old(run, write):
    write("spec.stl", SPEC.replace("500ms", "200ms"))
    sentence = "'y' has no sample from 0.05 s to 0.3 s, longer than the 200 ms for which a value is held"
    assert f"log.csv: {sentence}" in run("check", "spec.stl", "log.csv").err
    write("plain.stl", SPEC.replace("sample 100ms hold for 500ms\n", ""))
    options = ["--resample", "100ms", "--hold-for", "200ms"]
    assert f"log.csv: {sentence}" in run("check", "plain.stl", "log.csv", *options).err
    stream = run("monitor", "spec.stl", stdin=LOG)
    assert (stream.code, len(rows(stream))) == (2, 2)
    assert f"stdin, line 5: {sentence}" in stream.err


def test_wrong_streams(run):
    assert "values that are held need their time" in run("monitor", "spec.stl", stdin="x,y\n1,2\n").err
    late = run("monitor", "spec.stl", stdin="time,x,y\n1,1,1\n0.5,1,1\n")
    assert "stdin, line 3: time does not increase: 0.5 s comes after 1 s; sort the samples" in late.err
    assert "has no samples" in run("monitor", "spec.stl", stdin="time,x,y\n").err


def test_samples_that_are_nan_are_skipped(run, write):
    write("spec.stl", SPEC.replace("500ms", "500ms skip nan"))
    write("log.csv", LOG.replace("0.33,4,0", "0.33,4,nan"))
    (row,) = rows(run("check", "spec.stl", "log.csv", "--json"))
    assert (row["robustness"], row["notes"]) == (-1.0, ["left out, NaN: 1 sample of y, the first at 0.33 s"])
    stream = rows(run("monitor", "spec.stl", stdin=LOG.replace("0.33,4,0", "0.33,4,nan")))
    assert len(stream) == row["samples"] == 7
    write("spec.stl", SPEC)
    assert "'y' is NaN" in run("check", "spec.stl", "log.csv").err
    write("other.stl", "input float y  sample 100ms hold skip nan  always(y <= 3)")
    both = rows(run("check", "spec.stl", "other.stl", "log.csv", "--json"))
    assert ["error" in each for each in both] == [True, False]


def test_specifications_with_and_without_a_rule_read_one_recording(run, write):
    write("plain.stl", "input float x  historically(x <= 3)")
    write("even.csv", "time,x,y\n0,1,0\n0.1,,1\n0.2,2,\n0.3,4,0\n")
    for given in (["spec.stl", "plain.stl"], ["plain.stl", "spec.stl"]):
        found = {
            row["requirement"]: row
            for row in rows(run("check", *given, "even.csv", "--json", "--hold-for", "1s"))
        }
        assert found["R"]["samples"] == found["plain.stl"]["samples"] == 4
        assert found["plain.stl"]["robustness"] == 2.0


def test_imports_templates_types_parameters_bindings_units_and_sampling_work_together(run, write):
    write("all.stl", """\
        specification all
        import "signals.stl"
        enum Mode { MANUAL, AUTO }
        input float z [m] = "sp.z"
        input Mode mode
        parameter float band = 0.5 [m]
        sample 100ms hold for 1s skip nan
        def near(x, target, tol = band) = abs(x - target) <= tol
        require R1 "settles" severity warning: settles(z, 10, band, within=500ms)
        require R2: always(mode == AUTO -> eventually[0:1s] near(z, target=10))
        """)  # fmt: skip
    write(
        "all.csv", "time,sp.z [ft],mode\n0,0,AUTO\n0.25,20,\n0.5,nan,MANUAL\n0.61,32.9,AUTO\n1.2,32.8,AUTO\n"
    )
    found = rows(run("check", "all.stl", "all.csv", "--json"))
    assert [row["samples"] for row in found] == [13, 13]
    held, last = 20 * 0.3048, 32.9 * 0.3048  # metres
    assert [row["robustness"] for row in found] == pytest.approx([held - 9.5, 10.5 - last], abs=1e-9)
    assert found[0]["severity"] == "warning"
    wide = rows(run("check", "all.stl", "all.csv", "--json", "--set", "band=5"))
    assert [row["satisfied"] for row in wide] == [True, True]
