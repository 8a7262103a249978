"""The Simulink block of matlab/, in Octave, against a double of what Simulink hands to a block."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.formula import variables
from rtamt.signals.discrete import Discrete
from rtamt.verdicts.standalone import carried_program
from tests.strategies import formulas, traces

ROOT = Path(__file__).parents[2]
DOUBLES = Path(__file__).parent / "matlab"
BLOCK = "block = RuntimeBlock({{{}}});"
RESPONSE = "const float limit = 3  always[0:0.2]((req >= limit) -> eventually[0:0.3](gnt / scale >= limit))"
PERIOD = 0.1

needs_octave = pytest.mark.skipif(
    shutil.which("octave-cli") is None or shutil.which("mkoctfile") is None,
    reason="Octave is not installed; on Debian: apt-get install octave octave-dev",
)

Octave = Callable[..., str]


def run_octave(script: str, home: Path, *folders: Path) -> str:
    paths = "".join(f"addpath('{folder}');\n" for folder in folders)
    home.joinpath("script.m").write_text(paths + script, encoding="utf-8")
    done = subprocess.run(
        ["octave-cli", "--norc", "--no-history", "script.m"],
        cwd=home,
        env={**os.environ, "HOME": str(home), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """Install a copy as a user does, with the Python that runs the tests; a name with a space must do."""
    home = tmp_path_factory.mktemp("user s")
    sources = shutil.ignore_patterns("*.mex*", "*.so", "python.txt")
    shutil.copytree(ROOT / "matlab", home / "matlab", ignore=sources)
    said = run_octave(f"install_rtamt('{sys.executable}');", home, home / "matlab")
    assert said.splitlines()[0] == "rtamt is ready. For the next session, put this into startup.m:"
    return home / "matlab"


@pytest.fixture
def octave(installed, tmp_path) -> Octave:
    return lambda script: run_octave(script, tmp_path, installed, DOUBLES)


def bits(values: Any) -> list[int]:
    return np.array(values, np.float64).view(np.int64).tolist()


def expected_of(text: str, names: list[str], rows: np.ndarray) -> list[float]:
    monitor = rtamt.parse(text).monitor(period=PERIOD)
    told = [
        monitor.update(i * PERIOD, **dict(zip(names, row, strict=True)))
        for i, row in enumerate(rows.tolist())
    ]
    return [np.nan if value is None else value for value in told]


def wave(n: int) -> np.ndarray:
    rng = np.random.default_rng(11)
    return np.column_stack([rng.normal(4, 3, n), rng.uniform(0.5, 2, n), rng.normal(3, 2, n)])


# ---- values --------------------------------------------------------------------------------------

FILES = """
rows = reshape(fread(fopen('rows', 'r'), Inf, 'double'), 3, [])';
write = @(values) fwrite(fopen('values', 'w'), values, 'double');
times = (0:size(rows, 1) - 1)' * 0.1;
"""


@pytest.mark.parametrize("how", ["text", "file", "program", "offline"])
@needs_octave
def test_the_block_gives_the_bits_of_the_monitor_in_python(octave, tmp_path, how):
    rows = wave(40)
    rows.tofile(tmp_path / "rows")
    names = ["gnt", "scale", "req"]
    (tmp_path / "spec.stl").write_text(RESPONSE, encoding="utf-8")
    (tmp_path / "spec.rtamt").write_bytes(rtamt.parse(RESPONSE, period=PERIOD).compile().to_bytes())
    spec = {"file": "spec.stl", "program": "spec.rtamt"}.get(how, RESPONSE)
    expected = expected_of(RESPONSE, names, rows)
    if how == "offline":
        octave(FILES + f"write(rtamt_robustness('{spec}', 'gnt, scale, req', 0.1, rows));")
        columns = {name: rows[:, i] for i, name in enumerate(names)}
        result = rtamt.parse(RESPONSE, period=PERIOD).evaluate(columns)
        expected = list(result.signal.values)
    else:
        octave(
            FILES
            + BLOCK.format(f"'{spec}', {{'gnt', 'scale', 'req'}}, 0.1")
            + "write(simulate(block, times, rows));"
        )
        assert np.isnan(expected[4])
        assert not np.isnan(expected[5])
    assert bits(np.fromfile(tmp_path / "values")) == bits(expected)


@needs_octave
def test_minor_steps_and_algebraic_loops_do_not_advance_the_state(octave, tmp_path):
    rows = wave(40)
    rows.tofile(tmp_path / "rows")
    octave(
        FILES
        + BLOCK.format(f"'{RESPONSE}', 'gnt, scale, req', -1")
        + "write(simulate_roughly(block, times, rows));"
    )
    expected = expected_of(RESPONSE, ["gnt", "scale", "req"], rows)
    assert bits(np.fromfile(tmp_path / "values")) == bits(expected)


#: A program, the names of the elements of the input, samples, and what Python says of them.
Case = tuple[bytes, list[str], np.ndarray, list[float]]


@st.composite
def cases(draw: st.DrawFn) -> Case | None:
    """Draw a case; None where the block has nothing to do."""
    formula, columns = draw(formulas()), draw(traces(infinite=True))
    names = draw(st.permutations(variables(formula)))
    monitor = Monitor(formula)
    expected: list[float] = []
    rows = [{name: float(columns[name][i]) for name in names} for i in range(len(columns["x"]))]
    for row in rows:
        try:
            value = monitor.step(*(row[name] for name in monitor.input_names))
        except EvaluationError:
            break
        expected.append(np.nan if value is None else value)
    if not names or len(expected) < 2:
        return None
    taken = np.array([[row[name] for name in names] for row in rows[: len(expected)]])
    program = carried_program(formula, Discrete(period=1)).to_bytes()
    return program, list(names), taken, expected


MANY = """
for i = 0:{last}
    names = strsplit(fileread(sprintf('%d.names', i)), ' ');
    rows = reshape(fread(fopen(sprintf('%d.rows', i), 'r'), Inf, 'double'), numel(names), [])';
    block = RuntimeBlock({{sprintf('%d.rtamt', i), names, 1}});
    values = simulate(block, 0:size(rows, 1) - 1, rows);
    fwrite(fopen(sprintf('%d.values', i), 'w'), values, 'double');
    fclose('all');
end
"""


@settings(max_examples=3, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(st.lists(cases(), min_size=15, max_size=25))
@needs_octave
def test_whatever_the_requirement_is(octave, tmp_path, drawn):
    many = [case for case in drawn if case is not None]
    for i, (program, names, rows, _) in enumerate(many):
        (tmp_path / f"{i}.rtamt").write_bytes(program)
        (tmp_path / f"{i}.names").write_text(" ".join(names), encoding="utf-8")
        rows.tofile(tmp_path / f"{i}.rows")
    octave(MANY.format(last=len(many) - 1))
    for i, (_, _, _, expected) in enumerate(many):
        assert bits(np.fromfile(tmp_path / f"{i}.values")) == bits(expected)


# ---- the life of a block ---------------------------------------------------------------------------


@needs_octave
def test_the_block_takes_part_in_the_callbacks_of_the_engine(octave):
    said = octave(
        BLOCK.format("'always[0:1](x >= 3)', 'x', 1")
        + "disp(simulate(block, 0:2, [5; 4; 2])'); disp(strjoin(block.Called));"
        "disp([block.InputPort(1).DirectFeedthrough, block.SampleTimes]); disp(block.Dwork(1).Data);"
    )
    assert said.split("\n")[:4] == [
        "   NaN     1    -1",
        "SetInputPortDimensions PostPropagationSetup Start InitializeConditions "
        "Outputs Update Outputs Update Outputs Update Terminate",
        "   1   1   0",
        "0",
    ]


@needs_octave
def test_named_constants_are_set_beside_the_specification_and_outlast_a_reset(octave):
    said = octave(
        "spec = 'const float limit = 3  const float scale = 1  historically(x >= limit * scale)';"
        "block = RuntimeBlock({{spec, 'scale', 2, 'limit', single(2.5)}, 'x', 1}); block.prepare(1, -1);"
        "disp(block.step(0, 9)); block.call('InitializeConditions'); disp(block.step(0, 8));"
        "block.call('Terminate'); disp(rtamt_robustness({spec, 'limit', -1}, 'x', 1, [5; 3])');"
    )
    assert said.split() == ["4", "3", "6", "4"]


@needs_octave
def test_initial_conditions_begin_a_new_trace_at_any_time_and_two_blocks_are_two_monitors(octave):
    said = octave(
        "a = RuntimeBlock({'historically(x >= 3)', 'x', 0.1}); a.prepare(1, -1);"
        "b = RuntimeBlock({'historically(x >= 3)', 'x', 0.1}); b.prepare(1, -1);"
        "disp([a.step(0, 1), b.step(0, 7), a.step(0.1, 9), b.step(0.1, 8)]);"
        "a.call('InitializeConditions');"  # a subsystem that is enabled again
        "disp([a.step(0.7, 9), b.step(0.2, 6), a.step(0.8, 8)]);"
        "a.call('Terminate'); disp(b.step(0.3, 5)); b.call('Terminate');"
        "b.call('Start'); b.call('InitializeConditions'); disp(b.step(0, 4)); b.call('Terminate');"
    )
    assert said.split() == ["-2", "4", "-2", "4", "6", "3", "5", "2", "1"]


@needs_octave
def test_after_an_error_the_monitor_is_as_it_was(octave):
    said = octave(
        BLOCK.format("'always[0:1](x / y >= 1)', 'x y', 1") + "block.prepare(2, -1); block.step(0, [3 1]);"
        "for bad = [NaN 0; 1 0], try, block.step(1, bad), catch failure, disp(failure.message), end, end\n"
        "disp(block.step(1, [2 1]))"
    )
    assert said.splitlines() == [
        "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out.",
        "'x / y' has no value at sample 1, time 1 s: it is 0/0, inf - inf, 0 * inf, or a root or logarithm of a "
        "negative number; change the formula or the data so that this cannot happen.",
        "1",
    ]


# ---- what is refused -------------------------------------------------------------------------------

PREPARE = "block = RuntimeBlock({{{}}}); block.prepare({}, {});"
SPEC = "'always[0:1](x >= y)'"
CONSTANTS = "'const float limit = 3  x >= limit'"
REFUSED = {
    "a variable that the specification does not read": (
        PREPARE.format(f"{SPEC}, 'x, y, z', 1", 3, 1),
        "rtamt:variables",
        "The specification does not read 'z': take it out of the variables, and its signal out of the "
        "input. It reads x, y.",
    ),
    "a variable too few": (
        PREPARE.format(f"{SPEC}, 'x', 1", 1, 1),
        "rtamt:variables",
        "The specification reads 'y', which is not among the variables given: x.",
    ),
    "a variable twice": (
        PREPARE.format(f"{SPEC}, {{'x', 'y', 'x'}}, 1", 3, 1),
        "rtamt:variables",
        "The variable 'x' is named twice: each element of the input has its own.",
    ),
    "no names": (
        PREPARE.format(f"{SPEC}, [], 1", 2, 1),
        "rtamt:variables",
        "The names of the variables must be text, such as 'req, gnt', or a cell array of texts, such as "
        "{'req', 'gnt'}.",
    ),
    "a constant that is not there": (
        PREPARE.format(f"{{{CONSTANTS}, 'limitt', 4}}, 'x', 1", 1, 1),
        "rtamt:constants",
        "The specification has no constant 'limitt' that can be set: it has limit. A constant that bounds an "
        "interval is fixed.",
    ),
    "a constant that bounds an interval": (
        PREPARE.format("{'const float T = 1  always[0:T](x >= 1)', 'T', 2}, 'x', 1", 1, 1),
        "rtamt:constants",
        "The specification has no constant 'T' that can be set: it has none. A constant that bounds an "
        "interval is fixed.",
    ),
    "a constant without a value": (
        PREPARE.format(f"{{{CONSTANTS}, 'limit'}}, 'x', 1", 1, 1),
        "rtamt:constants",
        "After the specification come names and values of constants in turn, such as {'response.stl', "
        "'limit', 4}.",
    ),
    "a constant twice": (
        PREPARE.format(f"{{{CONSTANTS}, 'limit', 1, 'limit', 2}}, 'x', 1", 1, 1),
        "rtamt:constants",
        "The constant 'limit' is given twice.",
    ),
    "a constant that is a vector": (
        PREPARE.format(f"{{{CONSTANTS}, 'limit', [1 2]}}, 'x', 1", 1, 1),
        "rtamt:constants",
        "The constant 'limit' must be one real number.",
    ),
    "a constant that is NaN": (
        PREPARE.format(f"{{{CONSTANTS}, 'limit', NaN}}, 'x', 1", 1, 1),
        "rtamt:constants",
        "The parameter 'limit' may not be NaN.",
    ),
    "a vector of another width": (
        PREPARE.format(f"{SPEC}, 'x, y', 1", 3, 1),
        "rtamt:width",
        "The input has 3 elements, but the block has 2 variables (x, y): join one signal for each with a Mux, "
        "in this order.",
    ),
    "samples of another width": (
        f"rtamt_robustness({SPEC}, 'x, y', 1, [1 2 3]);",
        "rtamt:width",
        "The samples must be an array of real numbers with 2 columns, one for each variable: x, y.",
    ),
    "a period below 0": (
        PREPARE.format(f"{SPEC}, 'x, y', -2", 2, 1),
        "rtamt:period",
        "The sampling period must be a number of seconds above 0, or -1 for that of the input.",
    ),
    "an input without a period": (
        PREPARE.format(f"{SPEC}, 'x, y', -1", 2, 0),
        "rtamt:period",
        "The input has no sampling period: give the block one in seconds as its third parameter, or put a "
        "Zero-Order Hold or a Rate Transition before it.",
    ),
    "a period that the bounds do not fit": (
        PREPARE.format(f"{SPEC}, 'x, y', 0.7", 2, 1),
        "rtamt:specification",
        "The operator bound must be a multiple of the sampling period: 1 s is not a whole number of periods of "
        "700 ms; change the bound or the period\n"
        "  line 1, column 7:\n"
        "    always[0:1](x >= y)\n"
        "          ^^^^^",
    ),
    "a program of another period": (
        PREPARE.format("'good.rtamt', 'x, y', 0.5", 2, 1),
        "rtamt:period",
        "The program was compiled for a period of 1 s, but samples come every 0.5 s: compile it with "
        "'--period 0.5'.",
    ),
    "a sample that is late": (
        PREPARE.format(f"{SPEC}, 'x, y', 1", 2, 1) + "block.step(0, [1 2]); block.step(3, [1 2]);",
        "rtamt:period",
        "A sample comes at 3 s, but the one before came at 0 s and the period is 1 s: a subsystem that is "
        "switched on and off must reset its states when it is enabled.",
    ),
    "a damaged program": (
        PREPARE.format("'bad.rtamt', 'x, y', 1", 2, 1),
        "rtamt:program",
        "This is not a program that can be run: its checksum does not match, so it was damaged on the way.",
    ),
    "a program for dense time": (
        PREPARE.format("'dense.rtamt', 'x, y', 1", 2, 1),
        "rtamt:program",
        "The program is for dense time, but samples come once a period: compile it without '--time dense'.",
    ),
    "a specification that makes no sense": (
        PREPARE.format("'always[0:1](x >= ', 'x', 1", 1, 1),
        "rtamt:specification",
        "expected an operand after '>=', got the end of the text\n"
        "  line 1, column 17:\n"
        "    always[0:1](x >= \n"
        "                    ^",
    ),
    "a file that makes no sense": (
        PREPARE.format("'bad.stl', 'x', 1", 1, 1),
        "rtamt:specification",
        "bad.stl: expected an operand after '>=', got the end of the text\n"
        "  line 1, column 5:\n"
        "    x >=\n"
        "        ^",
    ),
    "a file that is not there": (
        PREPARE.format("'gone.stl', 'x', 1", 1, 1),
        "rtamt:specification",
        "There is no file 'gone.stl' (the current folder is HERE).",
    ),
    "no specification": (
        PREPARE.format("[], 'x', 1", 1, 1),
        "rtamt:specification",
        "The specification must be text, or the name of a file (.stl, or .rtamt as 'rtamt compile' writes it).",
    ),
    "a Python without rtamt": (
        "install_rtamt('/bin/false');",
        "rtamt:notInstalled",
        "rtamt is not installed in the Python '/bin/false': run 'pip install \"CHECKOUT\"' there, or name another "
        "one: install_rtamt('...'). It said: ",
    ),
}
TRY = """
try
    {}
catch failure
    printf('%s\\n%s\\x1e', failure.identifier, failure.message);
end
"""


@pytest.fixture(scope="module")
def refusals(installed, tmp_path_factory) -> dict[str, str]:
    """Try everything in one run of Octave; each answer is an identifier, a line break, and the message."""
    home = tmp_path_factory.mktemp("refused")
    good = rtamt.parse("always[0:1](x >= y)").compile().to_bytes()
    (home / "good.rtamt").write_bytes(good)
    (home / "bad.rtamt").write_bytes(good[:50] + b"\x5a" + good[51:])
    (home / "dense.rtamt").write_bytes(rtamt.parse("x >= y", time="dense").compile().to_bytes())
    (home / "bad.stl").write_text("x >=", encoding="utf-8")
    script = "".join(TRY.format(tried) for tried, _, _ in REFUSED.values())
    said = run_octave(script, home, installed, DOUBLES)
    said = said.replace(str(home), "HERE").replace(str(installed.parent), "CHECKOUT")
    return dict(zip(REFUSED, said.split("\x1e"), strict=False))


@pytest.mark.parametrize("what", REFUSED)
@needs_octave
def test_what_is_wrong_is_said(refusals, what):
    _, identifier, message = REFUSED[what]
    assert refusals[what] == f"{identifier}\n{message}"


@needs_octave
def test_where_nothing_is_installed_the_block_says_how(tmp_path):
    shutil.copytree(
        ROOT / "matlab", tmp_path / "matlab", ignore=shutil.ignore_patterns("*.mex*", "*.so", "python.txt")
    )
    said = run_octave(
        TRY.format(PREPARE.format("'x >= 3', 'x', 1", 1, 1)), tmp_path, tmp_path / "matlab", DOUBLES
    )
    assert said == (
        "rtamt:notInstalled\nThe gateway to rtamt is not built: run install_rtamt in the folder above "
        f"{tmp_path}/matlab/private.\x1e"
    )


@needs_octave
def test_a_program_runs_where_there_is_no_python_and_text_says_what_it_needs(installed, tmp_path):
    copied = tmp_path / "matlab"
    shutil.copytree(installed, copied)
    (copied / "private" / "python.txt").write_text("/nowhere/python\n", encoding="utf-8")
    (tmp_path / "spec.rtamt").write_bytes(rtamt.parse("x >= 3").compile().to_bytes())
    said = run_octave(
        "disp(rtamt_robustness('spec.rtamt', 'x', 1, [5; 1])');"
        + TRY.format("rtamt_robustness('x >= 3', 'x', 1, 5);"),
        tmp_path,
        copied,
    )
    values, identifier, message = said.split("\n", 2)
    assert values.split() == ["2", "-2"]
    assert identifier == "rtamt:notInstalled"
    assert message.startswith(
        "The specification cannot be compiled, for rtamt does not run in /nowhere/python: run install_rtamt "
        "with a Python that has it, or give a program that 'rtamt compile' has written elsewhere (.rtamt). It "
        "said: "
    )


def test_the_page_shows_a_specification_that_has_a_monitor():
    page = (ROOT / "docs/how-to/simulink.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"`'([^'`]+->[^'`]+)'`", page)
    assert rtamt.parse(text, period=PERIOD).compile().inputs == ("req", "gnt")


# ---- the sources -----------------------------------------------------------------------------------


def test_every_file_is_matlab_too():
    check = [sys.executable, "-m", "miss_hit.mh_lint", "--matlab", "2021a", "--ignore-config", "--single"]
    done = subprocess.run(
        [*check, ROOT / "matlab", DOUBLES], capture_output=True, text=True, check=False, cwd=DOUBLES
    )
    assert (done.returncode, done.stdout.count("everything seems fine")) == (0, 1), done.stdout


@needs_octave
def test_the_gateway_compiles_without_a_warning():
    folder = subprocess.run(
        ["mkoctfile", "-p", "OCTINCLUDEDIR"], check=True, capture_output=True, text=True
    ).stdout.strip()
    check = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-fsyntax-only"]
    includes = ["-isystem", folder, "-isystem", str(Path(folder).parent), "-I", ROOT / "core" / "c_api"]
    done = subprocess.run(
        [*check, *includes, ROOT / "matlab/private/rtamt_gateway.c"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
