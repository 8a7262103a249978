"""Run scripts in Octave."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
DOUBLES = Path(__file__).parent
needs_octave = pytest.mark.skipif(
    shutil.which("octave-cli") is None or shutil.which("mkoctfile") is None,
    reason="Octave is not installed; on Debian: apt-get install octave octave-dev",
)


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
