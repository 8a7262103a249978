"""``rtamt monitor``: what goes in, what comes out, and when."""

import json
import subprocess
import sys

import pytest


def lines(text):
    return [tuple(json.loads(line).values()) for line in text.splitlines()]


def jsonl(*samples):
    return "".join(json.dumps(sample) + "\n" for sample in samples)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_values_come_in_order_each_once_and_the_rest_at_the_end(run, backend):
    stdin = jsonl(*({"time": t, "x": x} for t, x in enumerate([5, 4, 6, 2])))
    answer = run("monitor", "always[0:2](x >= 3)", "--backend", backend, stdin=stdin)
    assert answer == (
        0,
        '{"time": 0.0, "robustness": 1.0}\n'
        '{"time": 1.0, "robustness": -1.0}\n'
        '{"time": 2.0, "robustness": -1.0}\n'
        '{"time": 3.0, "robustness": -1.0}\n',
        "",
    )


def test_a_line_may_have_more_than_the_formula_reads(run):
    stdin = jsonl({"level": "info", "time": 0, "x": 5, "tags": ["a"]}, {"time": 1, "x": 2, "more": None})
    assert lines(run("monitor", "x >= 3", stdin=stdin).out) == [(0.0, 2.0), (1.0, -1.0)]


@pytest.mark.parametrize(
    "stdin",
    [
        "time,x\n0,5\n1,2\n",
        "x;note;t [ms]\n5;a;0\n\n2;b;1000\n",
        "\ufeffsep=;\r\ntime;x\r\n0;5\r\n1;2\r\n",
        '\ufeff# comment\ntime,"x"\r\n0,5\r\n1," 2 "\r\n',
        jsonl({"time": 0, "x": 5}, {"time": 1, "x": 2}),
        "\ufeff\n" + jsonl({"t": 0, "x": 5}) + "\n# comment\n" + jsonl({"t": 1, "x": 2}),
        jsonl({"Timestamp": 0, "x": 5}, {"Timestamp": 1, "x": 2}),
        jsonl({"x": 5}, {"x": 2}),
    ],
)
def test_every_way_to_write_the_same_samples(run, stdin):
    assert run("monitor", "x >= 3", stdin=stdin) == (
        0,
        '{"time": 0.0, "robustness": 2.0}\n{"time": 1.0, "robustness": -1.0}\n',
        "",
    )


def test_a_row_that_may_be_a_sample_is_not_skipped_as_a_comment(run):
    answer = run("monitor", "x >= 3", stdin="y,x\n# a, comment\n1,5\n#N/A,2\n")
    assert (answer.code, answer.out) == (2, '{"time": 0.0, "robustness": 2.0}\n')
    assert answer.err.splitlines()[-1] == (
        "rtamt: stdin, line 4: '#N/A' may begin a sample or a comment: begin no sample with '#', and a comment with "
        "'# '"
    )


def test_fields_are_nested_objects_or_names_with_dots(run):
    nested, flat = jsonl({"req": {"value": 5}}), jsonl({"req.value": 5})
    assert lines(run("monitor", "req.value >= 3", stdin=nested).out) == [(0.0, 2.0)]
    assert lines(run("monitor", "req.value >= 3", stdin=flat).out) == [(0.0, 2.0)]


def test_infinities_and_truth_values(run):
    stdin = jsonl({"x": "inf"}, {"x": "-inf"}, {"x": True}, {"x": 1e308})
    expected = [(0.0, "inf"), (1.0, "-inf"), (2.0, 1.0), (3.0, 1e308)]
    assert lines(run("monitor", "x >= 0", stdin=stdin).out) == expected


def test_period_and_time_column(run):
    stdin = jsonl({"clock": 3.0, "time": 1, "x": 5}, {"clock": 3.1, "time": 1, "x": 2})
    answer = run("monitor", "once[0:100ms](x >= 3)", "--period", "0.1", "--time-column", "clock", stdin=stdin)
    assert lines(answer.out) == [(3.0, 2.0), (3.1, 2.0)]
    answer = run("monitor", "x >= 3", "--period", "0.5", "--time-column", "", stdin=stdin)
    assert lines(answer.out) == [(0.0, 2.0), (0.5, -1.0)]


def test_a_formula_may_read_time(run):
    assert lines(run("monitor", "time <= 1", stdin=jsonl({"time": 0}, {"time": 1})).out) == [(0, 1), (1, 0)]


def test_a_bad_line_ends_the_monitor_and_nothing_is_printed_after_it(run):
    stdin = jsonl({"x": 5}, {"x": 4}, {"y": 1}, {"x": 1})
    assert run("monitor", "always[0:1](x >= 3)", "--period", "1s", stdin=stdin) == (
        2,
        '{"time": 0.0, "robustness": 1.0}\n',
        "rtamt: stdin, line 3: the data has no 'x'; signals: y\n",
    )


def test_keep_going_leaves_bad_lines_out(run):
    stdin = "starting up\n" + jsonl({"x": 5}) + "{oops\n" + jsonl({"x": "abc"}, {"x": 4})
    answer = run("monitor", "x >= 3", "--keep-going", stdin=stdin)
    assert lines(answer.out) == [(0.0, 2.0), (1.0, 1.0)]
    assert answer.code == 2
    assert answer.err == (
        'rtamt: stdin, line 1: expected a JSON object, such as {"time": 0, "x": 1}, '
        "or a row of CSV column names, got 'starting up'\n"
        "rtamt: stdin, line 3: not JSON: Expecting property name enclosed in double quotes at column 2\n"
        "rtamt: stdin, line 4: 'x' is \"abc\", expected a number\n"
    )


def test_a_sample_that_is_left_out_leaves_a_gap_which_the_tolerance_may_allow(run):
    stdin = jsonl({"time": 0, "x": 5}, {"time": 1, "x": None}, {"time": 2, "x": 4})
    answer = run("monitor", "x >= 3", "--keep-going", stdin=stdin)
    assert lines(answer.out) == [(0.0, 2.0)]
    assert answer.err.splitlines()[1] == (
        "rtamt: stdin, line 3: sample 1 at 2 s is 2 s after the one before, expected 1 s (within 10%): "
        "give the right period, resample the trace, or use dense time (time='dense', on the command line --time dense)"
    )
    answer = run("monitor", "x >= 3", "--keep-going", "--tolerance", "inf", stdin=stdin)
    assert lines(answer.out) == [(0.0, 2.0), (2.0, 1.0)]


def test_a_formula_without_variables_counts_samples(run):
    assert lines(run("monitor", "true", stdin=jsonl({"a": 1}, {"a": 2})).out) == [(0.0, "inf"), (1.0, "inf")]


def test_dense_samples_may_hold_some_of_the_variables():
    lines = [
        '{"time": 0, "x": 5}',
        '{"time": 0.5, "y": 1}',
        '{"time": 2.5, "x": 4}',
        '{"time": 3, "y": 0}',
    ]
    done = subprocess.run(
        [sys.executable, "-m", "rtamt", "monitor", "--time", "dense", "always[0:1](x >= 3) and y >= 0"],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=True,
    )
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [(point["time"], point["robustness"]) for point in told] == [(0.5, 1.0), (1.5, 1.0), (3.0, 0.0)]


def test_a_dense_sample_without_a_time():
    done = subprocess.run(
        [sys.executable, "-m", "rtamt", "monitor", "--time", "dense", "x >= 0"],
        input='{"x": 5}',
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "rtamt: stdin, line 1: in dense time every sample needs its time\n"


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_boolean_semantics_prints_verdicts_where_the_robustness_is_zero(run, time):
    for text, robustness, verdict in (("x >= 3", "inf", True), ("x > 3", "-inf", False)):
        answer = run(
            "monitor", text, "--semantics", "boolean", "--time", time, stdin=jsonl({"time": 0, "x": 3})
        )
        assert json.loads(answer.out) == {"time": 0.0, "robustness": robustness, "satisfied": verdict}


def test_the_monitor_takes_every_semantics_and_prints_no_minus_before_zero(run):
    text = "input float u; output float y; u >= 3 -> not (y >= 3)"
    answer = run("monitor", text, "--semantics", "input-vacuity", stdin=jsonl({"time": 0, "u": 5, "y": 9}))
    assert answer == (0, '{"time": 0.0, "robustness": 0.0}\n', "")


def watch(run, formula, stdin, *options):
    answer = run("monitor", formula, "--time", "dense", *options, stdin=stdin)
    return answer.out.splitlines(), answer.err


def test_dense_cells_may_be_empty(run):
    told, errors = watch(run, "x >= 3 and y >= 0", "time,x,y\n0,5,\n0.5,,1\n1,2,2\n")
    assert (told, errors) == (['{"time": 0.5, "robustness": 1.0}', '{"time": 1.0, "robustness": -1.0}'], "")
    answer = run("monitor", "x >= 3 and y >= 0", stdin="time,x,y\n0,5,\n")
    assert (answer.code, answer.err) == (
        2,
        "rtamt: stdin, line 2: 'y' is missing at sample 0, but discrete time needs a value at every sample: "
        "fill the gap, or use dense time (--time dense); --verdict eager and --verdict interval take missing "
        "samples\n",
    )


def test_dense_nanoseconds_are_exact(run):
    start = 1_700_000_000 * 10**9
    stdin = jsonl({"time": start + 1, "x": 5}, {"time": start + 9, "x": None}, {"time": start + 11, "x": 1})
    expected = [
        '{"time": 1700000000.000000001, "robustness": "-inf"}',
        '{"time": 1700000000.000000011, "robustness": 5.0}',
    ]
    told, errors = watch(run, "once[10ns:10ns] x", stdin, "--time-unit", "ns")
    assert (told, errors) == (expected, "")
    told, errors = watch(run, "once[10ns:10ns] x", f"t [ns],x\n{start + 1},5\n{start + 11},1\n")
    assert (told, errors) == (expected, "")


def test_dense_stamps_may_be_dates(run):
    stdin = jsonl({"time": "2026-01-01T02:00:00+02:00", "x": 5}, {"time": "2026-01-01T00:00:01.5Z", "x": 2})
    told, errors = watch(run, "x >= 3", stdin)
    assert errors == ""
    assert [json.loads(line) for line in told] == [
        {"time": "2026-01-01T00:00:00.000000000", "robustness": 2.0},
        {"time": "2026-01-01T00:00:01.500000000", "robustness": -1.0},
    ]


def test_a_dense_stamp_too_far_from_0(run):
    _, errors = watch(run, "x", jsonl({"time": 10**30, "x": 5}), "--time-unit", "us")
    assert errors == (
        "rtamt: stdin, line 1: the time of 'x' is 1e+24 at sample 0, too large for seconds: "
        "subtract a start time\n"
    )


def test_a_csv_with_time_ms_is_not_satisfied_by_a_monitor_that_check_calls_violated(run, write):
    text = "time_ms,x\n" + "".join(f"{i * 500},{x}\n" for i, x in enumerate([1, -1, 1, 1]))
    formula = "historically[0:500ms](x >= 0)"
    write("log.csv", text)
    found = json.loads(run("check", f"always({formula})", "log.csv", "--json").out)
    assert (found["robustness"], found["period"], found["first_violation"]) == (-1.0, 0.5, 0.5)
    answer = run("monitor", formula, "--period", "500ms", stdin=text)
    assert lines(answer.out) == [(0.0, 1.0), (0.5, -1.0), (1.0, -1.0), (1.5, 1.0)]
    answer = run("monitor", "historically(x >= 0)", stdin=text)
    assert (answer.code, answer.err) == (
        2,
        "rtamt: stdin, line 3: sample 1 at 0.5 s is 0.5 s after the one before, expected 1 s (within 10%): "
        "give the right period, resample the trace, or use dense time (time='dense', "
        "on the command line --time dense)\n",
    )


@pytest.mark.parametrize(
    ("names", "values"), [(["t", "timestamp"], [0, 0]), (["sim_time"], [0]), (["elapsed"], [0])]
)
def test_a_stream_whose_time_column_is_not_clear_is_rejected_as_the_file_is(run, write, names, values):
    text = f"{','.join(names)},x\n{','.join(map(str, values))},1\n"
    write("log.csv", text)
    has = "several columns that" if len(names) > 1 else "a column that"
    sentence = (
        f"has {has} may hold the timestamps: {', '.join(map(repr, names))}; choose one with time=, "
        f"or on the command line --time-column ('' for none)\n"
    )
    assert run("check", "x >= 0", "log.csv").err == f"rtamt: log.csv {sentence}"
    assert run("monitor", "x >= 0", stdin=text).err == f"rtamt: stdin {sentence}"
    sample = dict(zip([*names, "x"], [*values, 1], strict=True))
    assert run("monitor", "x >= 0", stdin=jsonl(sample)).err == f"rtamt: stdin {sentence}"
    assert run("monitor", "x >= 0", "--time-column", "", stdin=text).code == 0


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("time,x,x\n0,1,2\n1,1,2\n", "has 2 columns called 'x'; rename all but one of them"),
        (
            "time,x,time\n0,1,0\n1,1,0\n",
            "has several columns that may hold the timestamps: 'time', 'time'; choose one with time=, or on the "
            "command line --time-column ('' for none)",
        ),
        (
            ",x\n0.0,1\n0.5,1\n",
            "has a column that may hold the timestamps: one without a name; name it, or choose one with time=, or on "
            "the command line --time-column ('' for none)",
        ),
    ],
)
def test_columns_that_are_ambiguous_are_rejected_as_in_the_file(run, write, text, problem):
    write("log.csv", text)
    assert run("check", "x >= 0", "log.csv").err == f"rtamt: log.csv {problem}\n"
    assert run("monitor", "x >= 0", stdin=text).err == f"rtamt: stdin {problem}\n"


def test_a_column_that_is_not_read_may_be_there_twice(run):
    assert run("monitor", "x >= 0", stdin="time,x,y,y\n0,1,2,3\n").out == '{"time": 0.0, "robustness": 1.0}\n'


def test_a_time_that_comes_later_is_not_left_out_of_account(run):
    for stdin in (jsonl({"x": 1}, {"x": 1, "time": 7}), "when,x\n,1\n2026-01-01,1\n"):
        answer = run("monitor", "x >= 0", stdin=stdin)
        name = "time" if stdin.startswith("{") else "when"
        assert (answer.code, answer.err.split(": ", 2)[2]) == (
            2,
            f"'{name}' may hold the timestamps, but is empty before: give every sample its time, "
            f"or choose one with time=, or on the command line --time-column ('' for none)\n",
        )


@pytest.mark.parametrize("number", ["1e400", "-1e999"])
def test_a_number_beyond_the_range_of_a_double_is_no_infinity(run, write, number):
    write("log.csv", f"time,x\n0,1\n1,{number}\n2,inf\n")
    sentence = f"line 3: 'x' is '{number}', beyond the range of a double; infinity is written inf\n"
    assert run("check", "x >= 0", "log.csv").err == f"rtamt: log.csv, {sentence}"
    assert run("monitor", "x >= 0", stdin=f"time,x\n0,1\n1,{number}\n").err == f"rtamt: stdin, {sentence}"
    answer = run("monitor", "x >= 0", stdin=f'{{"x": {number}}}\n')
    assert answer.err == f"rtamt: stdin, line 1: 'x' is {number}, beyond the range of a double\n"


def test_a_key_that_is_given_twice_is_rejected(run):
    answer = run("monitor", "x >= 0", stdin='{"x": 1, "y": 2, "x": -1}\n')
    assert answer.err == 'rtamt: stdin, line 1: the key "x" is given twice; give it once\n'


def test_each_requirement_stands_in_the_line(run):
    spec = "require R1: eventually[0:1](x >= 3); require R2: x <= 6"
    answer = run("monitor", spec, "--period", "1s", stdin='{"x": 2}\n{"x": 5}\n{"x": 7}\n')
    assert [json.loads(line) for line in answer.out.splitlines()] == [
        {"time": 0, "robustness": 2, "requirements": {"R1": 2, "R2": 4}},
        {"time": 1, "robustness": 1, "requirements": {"R1": 4, "R2": 1}},
        {"time": 2, "robustness": -1, "requirements": {"R1": 4, "R2": -1}},
    ]
    assert (answer.code, answer.err) == (0, "")


def test_in_dense_time_there_is_a_line_where_any_requirement_changes(run):
    spec = "require R1: eventually[0:1](x >= 3); require R2: y <= 6"
    stdin = "".join(
        json.dumps(row) + "\n"
        for row in (
            {"time": 0, "x": 5, "y": 5},
            {"time": 2, "y": 4},
            {"time": 3, "x": 4},
            {"time": 4, "x": 4, "y": 7},
        )
    )
    lines = run("monitor", spec, "--time", "dense", stdin=stdin).out.splitlines()
    told = [(row["time"], row["robustness"], row["requirements"]) for row in map(json.loads, lines)]
    assert told[0] == (0, 1, {"R1": 2, "R2": 1})
    assert (2, 2, {"R1": 2, "R2": 2}) in told
    assert (3, 1, {"R1": 1, "R2": 2}) in told
    assert told[-1] == (4, -1, {"R1": 1, "R2": -1})
    assert all(robustness == min(each.values()) for _, robustness, each in told)
    assert [time for time, _, _ in told] == sorted({time for time, _, _ in told})


def test_verdicts_are_printed_once_they_are_settled(run):
    stdin = jsonl(*({"time": t, "x": x} for t, x in enumerate([5, 4, 1, 7])))
    answer = run("monitor", "always[0:1](x >= 3)", "--verdict", "eager", stdin=stdin)
    assert lines(answer.out) == [(0.0, True, 1.0), (1.0, False, 2.0), (2.0, False, 2.0), (3.0, True, 3.0)]


def test_causation_is_printed_of_every_sample(run):
    stdin = jsonl(*({"time": t, "x": x} for t, x in enumerate([5, 1])))
    answer = run("monitor", "always(x >= 3)", "--verdict", "causation", stdin=stdin)
    assert answer.out == (
        '{"time": 0.0, "violation": 2.0, "satisfaction": "-inf"}\n'
        '{"time": 1.0, "violation": -2.0, "satisfaction": "-inf"}\n'
    )


def test_causation_in_dense_time_is_printed_of_every_sample_and_of_the_end(run):
    stdin = jsonl({"time": 0, "x": 5, "y": 4}, {"time": 1, "y": 1}, {"time": 2.5, "x": 4})
    answer = run(
        "monitor", "always(x >= 3 and y >= 3)", "--verdict", "causation", "--time", "dense", stdin=stdin
    )
    assert answer.out == (
        '{"time": 0.0, "violation": 1.0, "satisfaction": "-inf"}\n'
        '{"time": 1.0, "violation": -2.0, "satisfaction": "-inf"}\n'
        '{"time": 2.5, "violation": 1.0, "satisfaction": "-inf"}\n'
        '{"violation": -2.0, "satisfaction": -2.0, "final": true}\n'
    )


def test_bounds_are_printed_when_they_change(run):
    stdin = jsonl(*({"time": t, "x": x} for t, x in enumerate([5, 1])))
    answer = run("monitor", "always[0:1](x >= 3)", "--verdict", "interval", stdin=stdin)
    assert answer.out == (
        '{"time": 0.0, "lower": "-inf", "upper": 2.0, "final": false}\n'
        '{"time": 0.0, "lower": -2.0, "upper": -2.0, "final": true}\n'
        '{"time": 1.0, "lower": "-inf", "upper": -2.0, "final": false}\n'
        '{"time": 1.0, "lower": -2.0, "upper": -2.0, "final": true}\n'
    )


@pytest.mark.parametrize(
    ("formula", "states"),
    [
        ("always(x >= 3)", ["open", "violated since 1.0 s", "violated since 1.0 s"]),
        ("eventually(x >= 3)", ["can no longer be violated", "satisfied since 0.0 s"]),
    ],
)
def test_unbounded_future_is_watched_at_the_start(run, formula, states):
    stdin = jsonl(*({"time": t, "x": x} for t, x in enumerate([5, 1])))
    answer = run("monitor", formula, stdin=stdin)
    assert [json.loads(line)["status"] for line in answer.out.splitlines()] == states


def test_runs_of_instants_are_printed_in_dense_time(run):
    stdin = jsonl({"time": 0, "x": 5}, {"time": 1.5, "x": 4}, {"time": 2.5, "x": 1})
    dense = ("monitor", "always[0:1](x >= 3)", "--time", "dense", "--verdict")
    assert run(*dense, "eager", stdin=stdin).out == (
        '{"time": 0.0, "until": 0.500000001, "satisfied": true, "decided_at": 1.5}\n'
        '{"time": 0.500000001, "until": 1.5, "satisfied": true, "decided_at": 2.5}\n'
        '{"time": 1.5, "until": 2.500000001, "satisfied": false, "decided_at": 2.5}\n'
    )
    assert run(*dense, "interval", stdin=stdin).out.splitlines()[:2] == [
        '{"time": 0.0, "until": 1e-09, "lower": "-inf", "upper": 2.0, "final": false}',
        '{"time": 0.0, "until": 0.5, "lower": 2.0, "upper": 2.0, "final": true}',
    ]


def test_unbounded_future_is_watched_at_the_start_in_dense_time_too(run):
    stdin = jsonl({"time": "2026-01-01T00:00:00", "x": 5}, {"time": "2026-01-01T00:00:00.5", "x": 1})
    answer = run("monitor", "always(x >= 3)", "--time", "dense", stdin=stdin)
    states = [json.loads(line)["status"] for line in answer.out.splitlines()]
    assert states == ["open", *["violated since 2026-01-01T00:00:00.500000000"] * 2]


def test_samples_of_dense_time_need_their_times_for_verdicts_too(run):
    answer = run("monitor", "always(x >= 3)", "--time", "dense", stdin=jsonl({"x": 5}))
    assert answer.code == 2
    assert "line 1: in dense time every sample needs its time" in answer.err


def test_the_samples_that_decide_a_verdict_name_members_and_booleans(run):
    text = "enum Mode { MANUAL, AUTO = 4 } input Mode mode input bool p always[0:1](p -> mode == AUTO)"
    stdin = jsonl({"mode": 4, "p": 1}, {"mode": 0, "p": True})
    answer = run("monitor", text, "--verdict", "eager", "--explain", stdin=stdin).out.splitlines()[0]
    assert [cause["value"] for cause in json.loads(answer)["causes"]] == [True, "MANUAL"]


@pytest.mark.parametrize("verdict", [["--verdict", "eager"], ["--verdict", "interval"], []])
def test_a_sample_outside_its_declared_range_is_reported_before_the_horizon(run, verdict):
    formula = "input float x in [0, 10]  always" + ("[0:1]" if verdict else "") + "(x <= 12)"
    answer = run("monitor", formula, *verdict, stdin="time,x\n0,3\n1,11\n")
    assert (answer.code, answer.err) == (
        2,
        "rtamt: stdin, line 3: 'x' is 11.0 at sample 1, time 1 s, outside its declared range [0, 10]: correct the "
        "value, or declare a wider range\n",
    )
    assert len(answer.out.splitlines()) == 1
