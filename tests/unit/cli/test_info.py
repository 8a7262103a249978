"""``rtamt info``, for people and as JSON."""

import json

import pytest

from rtamt.compiler.passes import PASSES
from rtamt.engine import _core


def test_a_bounded_requirement(run, write):
    write(
        "spec.stl",
        "specification response\n"
        "input float req\n"
        "output float gnt\n"
        "@ topic(req, /plant/req)\n"
        "granted = eventually[0:5](gnt >= 3);\n"
        "always[0:10](req >= 3 -> granted)\n",
    )
    answer = run("info", "spec.stl")
    *facts, memory = answer.out.partition("program\n")[0].splitlines()
    assert facts == [
        "name       response",
        "formula    always[0:10](req >= 3 -> eventually[0:5](gnt >= 3))",
        "           granted = eventually[0:5](gnt >= 3)",
        "variables  input float req (/plant/req)",
        "           output float gnt",
        "period     1 s (the default; --period sets it)",
        "horizon    15 s: the value at t is known at t + 15 s",
        "pastified  historically[0:10](once[5:5](req >= 3) -> once[0:5](gnt >= 3))",
        "intervals  tight",
        "early      verdicts hold at the end of the trace",
    ]
    assert memory.startswith("memory     ")
    assert memory.endswith(" doubles), whatever the length of the trace")
    program = answer.out.partition("program\n")[2].splitlines()
    assert program[0] == "  %0   lag 0    input req"
    assert program[-1].endswith("-> output")
    assert (answer.code, answer.err) == (0, "")


def test_memory_is_what_a_monitor_takes(run):
    import rtamt

    formula = "always[0:1000](x >= 3)"
    told = json.loads(run("info", formula, "--period", "1", "--json").out)["memory"]
    assert told == rtamt.parse(formula).monitor(period=1).memory
    assert 1000 * 8 <= told <= 2.5 * 1001 * 8 + 1024


def test_unbounded_future_is_offline_only_and_the_reason_is_given(run):
    answer = run("info", "always(x >= 3)")
    assert answer == (
        0,
        "formula    always(x >= 3)\n"
        "variables  x\n"
        "period     1 s (the default; --period sets it)\n"
        "intervals  tight\n"
        "early      verdicts hold at the end of the trace\n"
        "online     no: 'always' without an upper bound needs the whole future and cannot be monitored "
        "online; give it a bound, such as always[0:10], evaluate the finished trace offline, "
        "or monitor its bounds or verdicts (verdict='interval', 'eager')\n",
        "",
    )


def test_bounds_that_need_another_period(run):
    answer = run("info", "once[0:100ms](x >= 3)")
    assert answer.out.splitlines()[-1] == (
        "online     no: The operator bound must be a multiple of the sampling period: 100 ms is not "
        "a whole number of periods of 1 s; change the bound or the period (the period is the default; "
        "period=, or on the command line --period, sets it)"
    )
    answer = run("info", "once[0:100ms](x >= 3)", "--period", "50ms")
    assert "period     50 ms\n" in answer.out
    assert "slide_max %2 n=3" in answer.out


def test_each_of_several_requirements_is_listed_with_its_horizon(run):
    text = 'low = x <= 3; require A "short" severity note: next(low); require B: always(low)'
    assert run("info", text).out.splitlines()[1:4] == [
        "           low = x <= 3",
        "requires   A: next(x <= 3)  (note, horizon 1 s, short)",
        "           B: always(x <= 3)  (error, offline only)",
    ]


def test_json(run):
    assert json.loads(run("info", "next(req.value >= 3)", "--json", "--backend", "python").out) == {
        "name": None,
        "requirements": [
            {
                "name": "requirement_1",
                "description": "",
                "severity": "error",
                "formula": "next(req.value >= 3)",
                "horizon": 1,
            }
        ],
        "formula": "next(req.value >= 3)",
        "latex": run("info", "next(req.value >= 3)", "--latex").out.strip(),
        "semantics": "standard",
        "variables": [
            {"name": "req.value", "type": None, "role": None, "unit": None, "recorded": None, "topic": None}
        ],
        "parameters": [],
        "period": 1.0,
        "resolution": None,
        "horizon": 1.0,
        "pastified": "req.value >= 3",
        "program": [
            "%0   lag 0    input req.value",
            "%1   lag 0    const 3.0",
            "%2   lag 0    sub %0 %1",
            "%3   lag 1    shift %2 fill=inf  -> output",
        ],
        "memory": None,
        "offline_only": None,
        "tight": True,
        "early_verdicts_hold": True,
    }


def test_json_of_an_offline_requirement(run):
    found = json.loads(run("info", "eventually(x >= 3)", "--json").out)
    assert [found[key] for key in ("horizon", "pastified", "program", "memory")] == [None] * 4
    assert found["offline_only"].startswith("'eventually' without an upper bound needs the whole future")


def test_latex_alone(run):
    assert run("info", "always[0:5](x >= 3)", "--latex") == (0, "\\mathbf{G}_{[0, 5]} (x \\geq 3)\n", "")


def test_without_the_core_everything_but_memory_is_told(run):
    answer = run("info", "always[0:5](x >= 3)", "--backend", "python")
    assert "memory     only the compiled core reports it (leave out --backend python)\n" in answer.out
    assert "slide_min" in answer.out


def test_a_formula_without_variables(run):
    assert "variables  none\n" in run("info", "true").out


@pytest.mark.parametrize("formula", ["x", "historically(x)", "x since[0:3] y", "always[0:100](x) or y"])
def test_memory_is_that_of_the_core(run, formula):
    import rtamt
    from rtamt.compiler.plan import compile_program
    from rtamt.rewrite.desugar import desugar

    spec = rtamt.parse(formula, period=1)
    program = compile_program((desugar(spec.formula),), spec.period, spec.input_names)
    told = json.loads(run("info", formula, "--json").out)["memory"]
    assert told == _core.memory(program.to_bytes())


def test_the_program_is_that_of_the_semantics(run):
    answer = run("info", "input float req; req >= 3", "--semantics", "output_robustness")
    assert answer.out.splitlines()[:3] == [
        "formula    req >= 3",
        "semantics  output_robustness",
        "variables  input float req",
    ]
    assert answer.out.splitlines()[-1] == "  %2   lag 0    holds_ge %0 %1  -> output"
    assert json.loads(run("info", "x", "--semantics", "boolean", "--json").out)["semantics"] == "boolean"


# ---- dense time --------------------------------------------------------------------------------------

DENSE = (
    "formula    always[0:10](req >= 3 -> eventually[0:70ms](gnt >= 3))\n"
    "variables  req\n"
    "           gnt\n"
    "resolution 1 ns, the tick in which time is counted\n"
    "horizon    10.07 s: the value at t is known at t + 10.07 s\n"
    "pastified  historically[0:10](once[70ms:70ms](req >= 3) -> once[0:70ms](gnt >= 3))\n"
    "intervals  tight\n"
    "early      verdicts hold at the end of the trace\n"
    "memory     that of the changes inside the windows, whatever the length of the trace\n"
    "program\n"
    "  %0   lag 0    input req\n"
    "  %1   lag 0    const 3.0\n"
    "  %2   lag 0    sub %0 %1\n"
    "  %3   lag 0    neg %2\n"
    "  %4   lag 0    input gnt\n"
    "  %5   lag 0    sub %4 %1\n"
    "  %6   lag 70000000 slide_max %5 n=70000000\n"
    "  %7   lag 70000000 shift %3 n=70000000 fill=0.0\n"
    "  %8   lag 70000000 max %7 %6\n"
    "  %9   lag 10070000000 slide_min %8 n=10000000000  -> output\n"
)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_in_dense_time_everything_is_counted_in_ticks(run, backend):
    formula = "always[0:10]((req >= 3) -> eventually[0:70ms](gnt >= 3))"
    assert run("info", formula, "--time", "dense", "--backend", backend) == (0, DENSE, "")


def test_json_in_dense_time(run):
    found = json.loads(run("info", "once[0:1ms](x)", "--time", "dense", "--json").out)
    assert [found[key] for key in ("period", "resolution", "horizon", "memory")] == [None, 1e-9, 0.0, None]
    assert found["program"][-1] == "%1   lag 0    slide_max %0 n=1000000  -> output"


def test_unbounded_future_in_dense_time_is_offline_only(run):
    answer = run("info", "always(x >= 3)", "--time", "dense")
    assert answer.out.splitlines()[-1] == (
        "online     no: 'always' without an upper bound needs the whole future and cannot be monitored "
        "online; give it a bound, such as always[0:10], evaluate the finished trace offline, "
        "or monitor its bounds or verdicts (verdict='interval', 'eager')"
    )


def test_what_dense_time_does_not_have_is_shown_at_its_place(run):
    assert run("info", "y or prev(x)", "--time", "dense") == (
        2,
        "",
        "rtamt: 'prev' means one sample away, which dense time does not have; "
        "use a window such as once[0:1], or discrete time\n"
        "  line 1, column 6:\n"
        "    y or prev(x)\n"
        "         ^^^^^^^\n",
    )


def test_a_bound_of_more_ticks_than_can_be_counted_says_what_to_do(run):
    assert run("info", "once[0:1e8](x)", "--time", "dense") == (
        2,
        "",
        "rtamt: 100000000 s is 1e+17 ticks of 1 ns, more than can be counted; "
        "shorten the bound, leave it open with inf, or choose a coarser resolution\n"
        "  line 1, column 5:\n"
        "    once[0:1e8](x)\n"
        "        ^^^^^^^\n",
    )


def test_what_bounds_and_early_verdicts_are_worth_is_reported(run):
    answer = run("info", "x >= 3 or x <= 1 or eventually[0:2] once[0:1] y >= 1")
    wide = "intervals  sound, but may be wider than necessary: 'x' raises and lowers the robustness\n"
    assert wide in answer.out
    cut = "early      verdicts may change at the end of the trace, which cuts the windows of 'eventually'\n"
    assert cut in answer.out


def test_info_lists_the_passes_and_the_program(run):
    lines = run("info", "x >= 3", "--program").out.splitlines()
    assert lines[0] == f"passes     {', '.join(PASSES)}"
    assert lines[1] == "program"
    assert lines[2].startswith("  %0   lag 0    input x")


def test_the_json_of_a_recording_lists_its_signals(run, write):
    write("log.csv", "t [ms],speed [m/s],note\n0,5,go\n1500,6,stop\n")
    assert json.loads(run("info", "log.csv", "speed", "--json").out) == {
        "trace": "log.csv",
        "signals": [
            {"name": "speed", "column": "speed [m/s]", "unit": "m/s", "samples": 2, "start": 0, "end": 1.5}
        ],
        "notes": ["time is 't [ms]', by its name", "left out, not numbers: note"],
    }
    for option in ("--latex", "--program"):
        assert run("info", "log.csv", option).err == (
            "rtamt: --latex and --program are for requirements, and this is a recording\n"
        )


def test_a_recording_without_timestamps_is_listed_as_such(run, write):
    write("log.csv", "Zeit,x\n0,5\n1,6\n")
    note = "no column holds timestamps: samples are one period apart"
    assert run("info", "log.csv").out.startswith(f"Trace of log.csv: 2 signals\n  {note}\n")
    told = json.loads(run("info", "log.csv", "--json").out)
    assert (told["notes"], told["signals"][0]["start"]) == ([note], None)
