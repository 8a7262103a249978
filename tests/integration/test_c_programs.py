"""The program of docs/how-to/c.md, linked with the installed C library by CMake and by pkg-config."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.unit.docs.pages import ROOT, blocks

# CMake and rtamt of the environment that runs the tests.
PATH = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
PAGE = (ROOT / "docs/how-to/c.md").read_text(encoding="utf-8")


def run(*command: str | Path, **environment: str) -> str:
    done = subprocess.run(
        command, check=False, capture_output=True, text=True, env={**os.environ, "PATH": PATH, **environment}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of the page, the compiled requirement, and the library in ``prefix``."""
    folder = tmp_path_factory.mktemp("c")
    for block in blocks(PAGE):
        if block.file is not None:
            (folder / block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "console":
            run("/bin/sh", "-ec", f"cd '{folder}'\n{block.text}")
    build = ROOT / "build/c"  # kept: the next run compiles what has changed
    settings = ["-DCMAKE_BUILD_TYPE=Debug", "-DRTAMT_BUILD_TESTS=OFF", "-G", "Ninja"]
    run("cmake", "-S", ROOT, "-B", build, *settings)
    run("cmake", "--build", build)
    run("cmake", "--install", build, "--prefix", folder / "prefix")
    return folder


def linked(program: Path) -> bool:
    return "librtamt.so.1 " in run("readelf", "--dynamic", program).replace("]", " ")


def test_programs_in_c_and_cpp_find_the_library_by_cmake(place: Path) -> None:
    run("cmake", "-S", place, "-B", place / "build", f"-DCMAKE_PREFIX_PATH={place / 'prefix'}")
    run("cmake", "--build", place / "build")
    runs = (("watch", "spec.rtamt", "expected.txt"), ("watch_dense", "dense.rtamt", "expected_dense.txt"))
    for name, compiled, expected in runs:
        program = place / "build" / name
        assert linked(program)
        assert run(program, place / compiled) == (place / expected).read_text("utf-8")


def test_a_c_program_finds_the_library_by_pkg_config(place: Path) -> None:
    if shutil.which("pkg-config") is None:
        pytest.skip("pkg-config is not installed")
    (moved,) = (place / "prefix").rename(place / "moved").glob("lib*")  # the file names no absolute path
    flags = run("pkg-config", "--cflags", "--libs", "rtamt", PKG_CONFIG_PATH=str(moved / "pkgconfig"))
    run("cc", "-std=c99", "-Wall", "-Werror", place / "watch.c", "-o", place / "watch", *flags.split())
    assert linked(place / "watch")
    said = run(place / "watch", place / "spec.rtamt", LD_LIBRARY_PATH=str(moved))
    assert said == (place / "expected.txt").read_text("utf-8")
    assert run("pkg-config", "--modversion", "rtamt", PKG_CONFIG_PATH=str(moved / "pkgconfig")) == "1.0.0\n"
