"""``rtamt check``: dense time, timestamps and their units, semantics."""

import json
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "examples" / "request_grant"
DENSE = "time,x,y\n0,1,0\n0.1,0,0\n0.37,0,1\n2,0,1\n"


def test_dense_time_has_no_period(run, write):
    write("events.csv", DENSE)
    formula = "always(x > 0.5 -> eventually[0:370ms](y > 0.5))"
    assert run("check", formula, "events.csv", "--time", "dense", "-o", "rho.csv") == (
        0,
        f"{formula}\n"
        "\n"
        "trace       samples  period  robustness  first violation  verdict\n"
        "events.csv        4   dense         0.5                -  satisfied\n",
        "",
    )
    assert Path("rho.csv").read_text() == "time,robustness\n0.0,0.5\n2.0,0.5\n"
    answer = run("check", formula, "events.csv", "--time", "dense", "--json")
    assert json.loads(answer.out) == {
        "requirement": formula,
        "trace": "events.csv",
        "satisfied": True,
        "robustness": 0.5,
        "first_violation": None,
        "samples": 4,
        "period": None,
        "episodes": {"count": 0, "worst": None, "first": []},
    }


def test_in_dense_time_a_variable_has_no_sample_where_its_cell_is_empty(run, write):
    write("events.csv", "time,x,y\n0,5,\n0.1,,1\n0.3,2,\n1,,\n")
    answer = run("check", "x >= 3 and y >= 0", "events.csv", "--time", "dense", "-o", "rho.csv")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[-1].split() == ["events.csv", "3", "dense", "1", "-", "satisfied"]
    assert Path("rho.csv").read_text() == "time,robustness\n0.1,1.0\n0.3,-1.0\n"
    assert run("check", "x >= 3", "events.csv") == (
        2,
        "",
        "rtamt: 'x' is missing at sample 1 of events.csv, but discrete time needs a value at every sample: "
        "fill the gap, hold the value before it (--hold-for DURATION), use dense time (--time dense), or put all on "
        "one time base (--resample PERIOD)\n",
    )


def test_an_empty_cell_beside_members_of_groups_is_rejected_with_the_options_of_the_command(run, write):
    write("cars.csv", "time,ego,car_1.x\n0,1,9\n1,,9\n2,1,\n")
    write("cars.stl", 'group cars = "car_*"\nalways(forall v in cars: v.x - ego > 5)')
    assert run("check", "cars.stl", "cars.csv") == (
        2,
        "",
        "rtamt: 'ego' is missing at sample 1 of cars.csv, but discrete time needs a value at every sample: "
        "fill the gap, hold the value before it (--hold-for DURATION), use dense time (--time dense), or put all on "
        "one time base (--resample PERIOD)\n",
    )
    assert run("check", "cars.stl", "cars.csv", "--hold-for", "1s").code == 0


@pytest.mark.parametrize(("header", "options"), [("t", ["--time-unit", "ns"]), ("t [ns]", [])])
def test_integer_nanoseconds_are_exact(run, write, header, options):
    start = 1_700_000_000 * 10**9
    write("log.csv", f"{header},x\n{start},5\n{start + 1},1\n{start + 100_000_001},5\n")
    answer = run("check", "once[100ms:100ms] x", "log.csv", "--time", "dense", "-o", "rho.csv", *options)
    assert answer.code == 1
    assert Path("rho.csv").read_text() == (
        "time,robustness\n1700000000,-inf\n1700000000.1,5.0\n1700000000.100000001,1.0\n"
    )


def test_nanoseconds_since_1970_without_their_unit_are_rejected(run, write):
    write("log.csv", "t,x\n1700000000000000000,5\n1700000000100000000,1\n")
    for time in ("discrete", "dense"):
        assert run("check", "x >= 3", "log.csv", "--time", time) == (
            2,
            "",
            "rtamt: the time of 't' of log.csv is 1700000000000000000 at sample 0, too large for seconds: if it "
            "counts ns since 1970, say time_unit='ns', or on the command line --time-unit ns\n",
        )


def test_a_unit_of_stamps_in_discrete_time(run, write):
    write("log.csv", "t,x\n0,5\n100,4\n200,3\n")
    answer = json.loads(run("check", "always[0:0.2](x)", "log.csv", "--time-unit", "ms", "--json").out)
    assert (answer["robustness"], answer["period"]) == (3.0, 0.1)


def test_dates_are_time_stamps_in_both_domains(run, write):
    write(
        "log.csv", "time,x\n2026-01-01T00:00:00Z,5\n2026-01-01T01:00:00.1+01:00,1\n2026-01-01 00:00:00.2Z,4\n"
    )
    assert run("check", "once[0.2:0.2] x or x", "log.csv", "--time", "dense", "-o", "rho.csv").code == 0
    assert Path("rho.csv").read_text() == (
        "time,robustness\n2026-01-01T00:00:00.000000000,5.0\n2026-01-01T00:00:00.100000000,1.0\n"
        "2026-01-01T00:00:00.200000000,5.0\n"
    )
    assert json.loads(run("check", "x", "log.csv", "--json").out)["period"] == 0.1


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (
            ("x", "--time", "dens"),
            "unknown time domain 'dens'; did you mean 'dense'? (time domains: dense, discrete)",
        ),
        (
            ("x", "--time", "dense", "--period", "1"),
            "dense time has no sampling period: leave out --period, or --time dense",
        ),
        (
            ("x", "--time", "dense", "--time-column", ""),
            "events.csv: dense time needs a column of timestamps: call it 'time', or name it with --time-column",
        ),
        (
            ("prev(x)", "--time", "dense"),
            "'prev' means one sample away, which dense time does not have; "
            "use a window such as once[0:1], or discrete time\n"
            "  line 1, column 1:\n"
            "    prev(x)\n"
            "    ^^^^^^^",
        ),
    ],
)
def test_what_dense_time_cannot_do(run, write, args, message):
    formula, *options = args
    answer = run("check", formula, write("events.csv", DENSE), *options)
    assert answer == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("semantics", "values"),
    [("output_robustness", [3, "inf", -2, -2]), ("input-vacuity", [0, 1, 0, 0])],
)
def test_the_four_recordings_under_interface_aware_semantics(run, semantics, values, time):
    traces = map(str, sorted(EXAMPLES.glob("*.csv")))
    spec = str(EXAMPLES / "spec.stl")
    answer = run("check", spec, *traces, "--json", "--semantics", semantics, "--time", time)
    found = [json.loads(line) for line in answer.out.splitlines()]
    assert [row["robustness"] for row in found] == values
    assert [row["satisfied"] for row in found] == [True, True, False, False]


@pytest.mark.parametrize("command", ["check", "explain"])
def test_a_signal_without_samples_in_dense_time_is_not_reported_as_a_missing_column_of_timestamps(
    run, command
):
    Path("empty.csv").write_text("time,x\n0,nan\n1,nan\n")
    answer = run(command, "x >= 3", "empty.csv", "--time", "dense", "--skip-nan", "x")
    assert answer.code == 2
    assert answer.err.splitlines()[-1] == "rtamt: empty.csv: 'x' has no samples: give at least one"
    Path("plain.csv").write_text("x\n1\n2\n")
    assert "needs a column of timestamps" in run(command, "x >= 3", "plain.csv", "--time", "dense").err
