"""The notebooks run from top to bottom, and are committed without output."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb"))


def test_there_are_two():
    assert [path.stem for path in NOTEBOOKS] == ["offline", "online"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    program = (
        "import sys, nbformat, nbclient\n"
        "notebook = nbformat.read(sys.argv[1], as_version=4)\n"
        "nbclient.NotebookClient(notebook, timeout=120, kernel_name='python3').execute()\n"
        "for cell in notebook.cells:\n"
        "    for output in cell.get('outputs', []):\n"
        "        print(output.get('text', ''), end='')\n"
    )
    # A process of its own: what Jupyter warns of is not ours to mend.
    done = subprocess.run(
        [sys.executable, "-c", program, str(path)],
        cwd=tmp_path, env={**os.environ, "MPLBACKEND": "agg", "JUPYTER_PLATFORM_DIRS": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = {"offline": "first violated at", "online": "values were still open"}[path.stem]
    assert told in done.stdout


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_committed_without_output(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert all(
        not cell["outputs"] and cell["execution_count"] is None
        for cell in cells
        if cell["cell_type"] == "code"
    )


def test_a_plot_is_a_picture_once_in_a_kernel_that_has_drawn_nothing_before(tmp_path):
    program = (
        "import nbformat, nbclient\n"
        'cell = nbformat.v4.new_code_cell(\'import rtamt; rtamt.parse("x >= 3").evaluate({"x": [5, 2]}).plot()\')\n'
        "notebook = nbformat.v4.new_notebook(cells=[cell])\n"
        "nbclient.NotebookClient(notebook, timeout=120, kernel_name='python3').execute()\n"
        "print([kind for output in cell.outputs for kind in output.get('data', {})])\n"
    )
    environment = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"}
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path, env={**environment, "JUPYTER_PLATFORM_DIRS": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("image/png") == 1
