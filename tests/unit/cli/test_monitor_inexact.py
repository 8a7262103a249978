"""Missing, uncertain and late samples: ``rtamt monitor`` prints what the monitor of Python reports."""

import json
import random

import pytest

import rtamt

FORMULAS = ["always[0:2](x > 3) or y > 3", "once[0:2](x > y)", "x > 3 until[0:2] y > 2"]
UNBOUNDED = "always(x > 1 -> eventually[0:2](y > 3))"
BOTH = "--verdict eager and --verdict interval"
EXPECTED = "expected a number, bounds [lower, upper], or null if it is missing"


def samples_of(random_, time, late, bounds=True):
    """Return samples: times, in order unless ``late``, and values, each exact, a pair of bounds, or None."""
    places = list(range(14))
    if late:
        places = sorted(places, key=lambda place: place + random_.uniform(0, 3))
    found = []
    for place in places:
        values = {}
        for name in "xy":
            lower, kind = random_.randint(0, 12) / 2, random_.random()
            values[name] = lower if kind < 0.5 or not place else None if kind < 0.75 else (lower, lower + 0.5)
            if isinstance(values[name], tuple) and not bounds:
                values[name] = None
            elif values[name] is None and late and random_.random() < 0.5:
                del values[name]
        found.append((place / (4 if time == "dense" else 1), values))
    return found


def number(value):
    return value if abs(value) < float("inf") else str(value)


def ends(interval):
    return {"lower": number(interval.lower), "upper": number(interval.upper)}


def line(report):
    """Return the members of a line about a verdict, a run of verdicts, or a change of bounds."""
    begin = report.time if hasattr(report, "time") else report.begin
    members = {"time": begin}
    if getattr(report, "end", begin) != begin:
        members["until"] = report.end
    if hasattr(report, "satisfied"):
        return members | {"satisfied": report.satisfied, "decided_at": report.decided_at}
    members |= ends(report.interval) | {"final": report.final}
    return members | ({"retracted": True} if report.retracted else {})


def reports(monitor, samples, time):
    """Return what a monitor of Python reports, as lines of the command."""
    found, before = [], None
    for at, values in samples:
        dense = time == "dense"  # null is no sample there
        known = {name: value for name, value in values.items() if not dense or value is not None}
        news = monitor.update(at, **known)
        if getattr(monitor, "at", "every") == "every":
            found += map(line, monitor.changes() if news is None else news)
        elif monitor.interval() != before:
            before = monitor.interval()
            found.append({"time": at} | ends(before))
    found += map(line, monitor.finish())
    if getattr(monitor, "at", "every") == "start":
        found.append(ends(monitor.interval()) | {"final": True})
    return found


def csv(samples):
    rows = [(time, *(values.get(name) for name in "xy")) for time, values in samples]
    cells = (",".join("" if cell is None else str(cell) for cell in row) for row in rows)
    return "\n".join(["t,x,y", *cells]) + "\n"


def jsonl(samples):
    return "".join(json.dumps({"t": time, **values}) + "\n" for time, values in samples)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("form", ["json", "csv"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("verdict", "formulas", "settings"),
    [
        ("eager", FORMULAS, {}),
        ("interval", FORMULAS, {}),
        ("interval", [UNBOUNDED], {}),
        ("interval", FORMULAS, {"lateness": "4s"}),
        ("interval", [UNBOUNDED], {"lateness": "4s"}),
    ],
)
def test_every_line_is_what_the_monitor_of_python_reports(run, verdict, formulas, settings, time, form, seed):
    samples = samples_of(random.Random(seed), time, bool(settings), bounds=form == "json")
    options = [option for name, value in settings.items() for option in (f"--{name}", value)]
    for formula in formulas:
        monitor = rtamt.parse(formula).monitor(verdict=verdict, time=time, **settings)
        expected = reports(monitor, samples, time)
        code, out, err = run(
            "monitor", formula, "--verdict", verdict, "--time", time, *options,
            stdin=jsonl(samples) if form == "json" else csv(samples),
        )  # fmt: skip
        got = [json.loads(each) for each in out.splitlines()]
        if formula == UNBOUNDED:
            got = bounds_alone(got)
        assert (code, err) == (0, "")
        assert got == expected
        assert expected


def bounds_alone(lines):
    """Return lines about the start of the trace without the status, and those that show the same bounds once."""
    found = []
    for each in lines:
        del each["status"]
        shown = {name: each[name] for name in ("lower", "upper")}
        if "final" in each or not found or {name: found[-1][name] for name in shown} != shown:
            found.append(each)
    return found


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_correction_is_rejected_or_replayed_as_in_python(run, time):
    samples = [(0, {"x": 5}), (1, {"x": 6}), (2, {"x": 7}), (1, {"x": 2}), (3, {"x": 4})]
    options = ["monitor", "x > 3", "--verdict", "interval", "--time", time, "--lateness", "2s"]
    spec = rtamt.parse("x > 3")
    monitor = spec.monitor(verdict="interval", time=time, lateness="2s", on_correction="replay")
    code, out, err = run(*options, "--on-correction", "replay", stdin=jsonl(samples))
    lines = [json.loads(each) for each in out.splitlines()]
    assert (code, lines, err) == (0, reports(monitor, samples, time), "")
    assert any(each.get("retracted") for each in lines)
    monitor = spec.monitor(verdict="interval", time=time, lateness="2s")
    with pytest.raises(rtamt.TraceError) as error:
        reports(monitor, samples, time)
    code, _, err = run(*options, stdin=jsonl(samples))
    assert (code, err) == (2, f"rtamt: stdin, line 4: {error.value}\n")


def test_a_sample_beyond_the_lateness_is_reported(run):
    lines = jsonl([(0, {"x": 5}), (3, {"x": 6}), (1, {"x": 2})])
    code, _, err = run("monitor", "x > 3", "--verdict", "interval", "--lateness", "1s", stdin=lines)
    assert (code, err) == (
        2,
        "rtamt: stdin, line 3: sample 2, at 1 s, is later than the lateness of 1 s allows: everything up to 1 s is "
        "final; leave it out, or allow for more lateness\n",
    )


@pytest.mark.parametrize("verdict", ["eager", "interval"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ("[5.0, 4.8]", "reversed: give the lower bound first"),
        ("[1]", EXPECTED),
        ("[]", EXPECTED),
        ("[1, 2, 3]", EXPECTED),
        ('[1, "a"]', EXPECTED),
        ("[1, null]", EXPECTED),
        ("[[1, 2], 3]", EXPECTED),
        ('"a"', EXPECTED),
        ('{"a": 1}', EXPECTED),
        ("[NaN, 5]", "with a bound that is NaN: give numbers, or null if it is missing"),
        ("[1, NaN]", "with a bound that is NaN: give numbers, or null if it is missing"),
    ],
)
def test_bounds_that_are_none_are_reported_with_their_line(run, verdict, time, value, problem):
    code, out, err = run(
        "monitor", "x > 3", "--verdict", verdict, "--time", time, stdin=f'{{"t": 0, "x": {value}}}\n'
    )
    assert (code, out, err) == (2, "", f"rtamt: stdin, line 1: 'x' is {value}, {problem}\n")


@pytest.mark.parametrize("verdict", ["delayed", "causation"])
def test_other_modes_name_those_that_take_missing_samples_and_bounds(run, verdict):
    def problem(stdin):
        code, out, err = run("monitor", "x > 3", "--verdict", verdict, stdin=stdin)
        assert (code, out) == (2, "")
        return err

    missing = (
        "'x' is missing at sample 0, but discrete time needs a value at every sample: fill the gap, or use dense time "
        f"(--time dense); {BOTH} take missing samples\n"
    )
    assert problem('{"t": 0, "x": null}\n') == f"rtamt: stdin, line 1: {missing}"
    assert problem("t,x\n0,\n") == f"rtamt: stdin, line 2: {missing}"
    assert problem('{"t": 0, "x": [1, 2]}\n') == (
        f"rtamt: stdin, line 1: 'x' is [1, 2], expected a number; {BOTH} take bounds\n"
    )


def test_a_member_and_a_truth_may_be_uncertain_and_explained(run, write):
    spec = write("f.stl", "enum M { A, B, C }\ninput M m\ninput bool on\nm != C and on\n")
    stdin = '{"t": 0, "m": ["A", "B"], "on": [false, true]}\n{"t": 1, "m": "C", "on": null}\n'
    assert run("monitor", spec, "--verdict", "interval", stdin=stdin)[1].splitlines() == [
        '{"time": 0.0, "lower": "-inf", "upper": "inf", "final": true}',
        '{"time": 1.0, "lower": "-inf", "upper": "-inf", "final": true}',
    ]
    code, out, err = run(
        "monitor", "x > 3", "--verdict", "eager", "--explain", stdin='{"t": 0, "x": [4, "inf"]}\n'
    )
    assert (code, err) == (0, "")
    assert out == (
        '{"time": 0.0, "satisfied": true, "decided_at": 0.0, '
        '"causes": [{"variable": "x", "time": 0.0, "value": [4.0, "inf"]}]}\n'
    )


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (["x > 3", "--lateness", "2s"],
         "--lateness is for bounds, which late samples change: use --verdict interval, or leave it out"),
        (["x > 3", "--verdict", "eager", "--on-correction", "replay"],
         "--on-correction is for bounds, which late samples change: use --verdict interval, or leave it out"),
        (["x > 3", "--verdict", "interval", "--lateness", "2s"],
         "stdin, line 2: a sample that may be late needs its time: name the column of timestamps, or leave out "
         "--lateness and --on-correction"),
        (["sample 1s hold\nx > 3", "--verdict", "interval", "--lateness", "2s"],
         "'sample 1s hold' samples the stream in order: leave out --lateness and --on-correction"),
        (['group cars = "car_*"; always[0:1](forall v in cars: v.x > 5)', "--verdict", "interval", "--lateness", "2s"],
         "the formula quantifies over 'cars', whose members come and go, and 'rtamt monitor' does not support "
         "--lateness for it: leave that out, or check recordings with 'rtamt check'"),
    ],
)  # fmt: skip
def test_late_samples_need_bounds_and_times(run, options, problem):
    assert run("monitor", *options, stdin="x\n5\n") == (2, "", f"rtamt: {problem}\n")
