"""NumPy is imported with its first use, and complete then."""

import ast
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rtamt

SOURCE = Path(rtamt.__file__).parent

WITHOUT_ARRAYS = {
    "a monitor": "print(rtamt.parse('always[0:1](x > 2)').monitor().update(0.0, x=3))",
    "steps": "print(rtamt.parse('x > 2').monitor(period='100ms', watch=['x - 1'], semantics='boolean').step(3))",
    "members": (
        "spec = rtamt.parse('enum M { A, B } input M m  input bool p  parameter float d = 1  p and m == A')\n"
        "print(spec.with_parameters(d=2).monitor().update(0, m='A', p=True))"
    ),
    "fractions": (
        "from fractions import Fraction\n"
        "monitor = rtamt.parse('x > 2').monitor()\nprint(monitor.update(Fraction(1, 2), x=Fraction(7, 2)))"
    ),
    "verdicts": "print(rtamt.parse('always(x > 2)').monitor(verdict='eager').update(0.0, x=1))",
    "bounds": "print(rtamt.parse('always(x > 2)').monitor(verdict='interval').update(0.0, x=1))",
    "a program": "print(len(rtamt.parse('always[0:1](x > 2)').compile().to_bytes()))",
    "warnings": "print(rtamt.parse('prev(x) - x <= 3').warnings)",
}


@pytest.fixture(scope="module")
def loaded():
    """From each use to whether numpy was loaded before and after it."""
    lines = ["import sys, rtamt", "told, sys.stdout = sys.stdout, sys.stderr"]
    for name, code in WITHOUT_ARRAYS.items():
        lines += [code, f"print({name!r}, 'numpy' in sys.modules, sep=':', file=told)"]
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=True
    )
    return dict(line.split(":") for line in done.stdout.splitlines())


@pytest.mark.parametrize("use", WITHOUT_ARRAYS)
def test_numpy_is_not_imported_where_no_array_is_made(loaded, use):
    assert loaded[use] == "False"


#: What evaluates recordings or members, or by definition: no part of a monitor of plain numbers.
NOT_FOR_MONITORS = (
    "threading",
    "rtamt.results",
    "rtamt.verdicts.offline",
    "rtamt.engine.discrete.evaluate",
    "rtamt.engine.user_operators",
    "rtamt.reference.discrete_robustness",
    "rtamt.rewrite.quantifiers",
    "rtamt.rewrite.pastify",
    "rtamt.signals.inexact",
    "rtamt.signals.members",
)


def test_a_monitor_does_not_wait_for_what_evaluates_recordings():
    code = f"import sys, rtamt\n{WITHOUT_ARRAYS['a monitor']}\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    known, loaded = done.stdout.splitlines()
    assert known == "None"
    assert [each for each in NOT_FOR_MONITORS if each in loaded.split()] == []
    assert all(importlib.util.find_spec(each) for each in NOT_FOR_MONITORS)


COMMAND = """
import sys
from rtamt.cli import main
code = main(sys.argv[1:])
print("numpy" in sys.modules, [each for each in ("multiprocessing", "asyncio") if each in sys.modules], code)
"""


def last_line(*argv):
    done = subprocess.run([sys.executable, "-c", COMMAND, *argv], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1]


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "limit.stl"
    path.write_text("input float x [m] parameter float limit = 4 [m] always[0:2](x <= limit)")
    return str(path)


@pytest.mark.parametrize(
    "argv",
    [("lint", "SPEC"), ("lint", "SPEC", "--online", "--period", "1s"), ("operators",)],
    ids=" ".join,
)
def test_numpy_is_not_imported_by_commands_that_compute_nothing(spec, argv):
    assert last_line(*(spec if each == "SPEC" else each for each in argv)) == "False [] 0"


def test_a_check_of_one_recording_starts_no_processes(spec, tmp_path):
    trace = tmp_path / "x.csv"
    trace.write_text("time,x\n0,1\n1,2\n2,3\n3,4\n")
    assert last_line("check", spec, str(trace)) == "True [] 0"


USES = {
    "a submodule": "assert np.linalg.norm([3, 4]) == 5",
    "a submodule imported by others": "import numpy.ma; assert np.ma is numpy.ma",
    "a class": "import numpy; assert np.float64 is numpy.float64 and np.__version__ == numpy.__version__",
    "a missing name": "try: np.no_such_name\nexcept AttributeError as error: assert 'no_such_name' in str(error)",
    "threads": (
        "from concurrent.futures import ThreadPoolExecutor\n"
        "with ThreadPoolExecutor(8) as pool: assert sum(pool.map(lambda k: int(np.sum([k])), range(8))) == 28"
    ),
}


@pytest.mark.parametrize("use", USES)
def test_numpy_is_complete_at_its_first_use(use):
    begin = "import sys; from rtamt.lazy.modules import np; assert 'numpy' not in sys.modules\n"
    end = "\nimport numpy, types; assert type(np) is types.ModuleType and np.array is numpy.array"
    subprocess.run([sys.executable, "-c", f"{begin}{USES[use]}{end}"], check=True)


def test_numpy_is_imported_in_one_place():
    paths = [
        path for path in SOURCE.rglob("*.py") if path.relative_to(SOURCE).as_posix() != "lazy/modules.py"
    ]
    assert {path.name: line for path in paths for line in imports_at_run_time(path)} == {}


def imports_at_run_time(path):
    """Yield the lines of a module that import numpy other than for type checkers."""
    text = path.read_text(encoding="utf-8")
    pending = [ast.parse(text)] if re.search(r"\b(import|from) numpy\b", text) else []
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import) and any(each.name.split(".")[0] == "numpy" for each in node.names):
            yield node.lineno
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "numpy":
            yield node.lineno
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            pending += node.orelse
        else:
            pending += ast.iter_child_nodes(node)
