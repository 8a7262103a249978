"""Commands that compute nothing do not wait for numpy, and those that do find it complete."""

import subprocess
import sys

import pytest

LOADED = """
import sys
from rtamt.cli import main
code = main(sys.argv[1:])
print("numpy._core" in sys.modules, [each for each in ("multiprocessing", "asyncio") if each in sys.modules], code)
"""


def last_line(*argv):
    done = subprocess.run([sys.executable, "-c", LOADED, *argv], capture_output=True, text=True, check=True)
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
def test_numpy_is_not_imported_where_nothing_is_computed(spec, argv):
    assert last_line(*(spec if each == "SPEC" else each for each in argv)) == "False [] 0"


def test_a_check_of_one_recording_starts_no_processes(spec, tmp_path):
    trace = tmp_path / "x.csv"
    trace.write_text("time,x\n0,1\n1,2\n2,3\n3,4\n")
    assert last_line("check", spec, str(trace)) == "True [] 0"


USES = {
    "a submodule": "import numpy.linalg; assert numpy.linalg.norm([3, 4]) == 5",
    "a name from a submodule": "from numpy.linalg import norm; assert norm([3, 4]) == 5",
    "a name": "from numpy import float64; assert float64(1) == 1",
    "a submodule before": "import numpy; assert numpy.ma.MaskedArray and numpy.array([1]).sum() == 1",
    "threads": (
        "import numpy; from concurrent.futures import ThreadPoolExecutor\n"
        "with ThreadPoolExecutor(8) as pool: assert sum(pool.map(lambda k: int(numpy.sum([k])), range(8))) == 28"
    ),
}


@pytest.mark.parametrize("use", USES)
def test_numpy_is_complete_at_its_first_use(use):
    begin = "from rtamt.cli.numpy_on_use import load_numpy_on_use; load_numpy_on_use(); import numpy, sys\n"
    end = "\nassert numpy is sys.modules['numpy'] and numpy.__version__ and 'numpy._core' in sys.modules"
    subprocess.run(
        [sys.executable, "-c", f"{begin}assert 'numpy._core' not in sys.modules\n{USES[use]}{end}"],
        check=True,
    )
