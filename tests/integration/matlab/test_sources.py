"""The files of matlab/ are legal MATLAB and legal C."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.integration.matlab.octave import DOUBLES, ROOT, needs_octave


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
