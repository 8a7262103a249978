"""What the Simulink block and its installation reject, in which words."""

from __future__ import annotations

import shutil

import pytest

import rtamt
from tests.integration.matlab.octave import DOUBLES, ROOT, needs_octave, run_octave

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
