"""The programs of docs/how-to/c.md and fleet.md, linked with the installed C library by CMake and by pkg-config."""

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
    settings = ["-DCMAKE_BUILD_TYPE=Release", "-DRTAMT_BUILD_TESTS=OFF", "-G", "Ninja"]
    run("cmake", "-S", ROOT, "-B", build, *settings)
    run("cmake", "--build", build)
    run("cmake", "--install", build, "--prefix", folder / "prefix")
    return folder


def link(program: Path) -> bool:
    return "librtamt.so.1 " in run("readelf", "--dynamic", program).replace("]", " ")


def test_programs_in_c_and_cpp_find_the_library_by_cmake(place: Path) -> None:
    run("cmake", "-S", place, "-B", place / "build", f"-DCMAKE_PREFIX_PATH={place / 'prefix'}")
    run("cmake", "--build", place / "build")
    runs = (("watch", "spec.rtamt", "expected.txt"), ("watch_dense", "dense.rtamt", "expected_dense.txt"))
    for name, compiled, expected in runs:
        program = place / "build" / name
        assert link(program)
        assert run(program, place / compiled) == (place / expected).read_text("utf-8")


#: Calls the functions of docs/how-to/fleet.md: two cars in order, one whose samples come late, and verdicts of two.
FLEETS = r"""
static size_t read_program(const char* name, unsigned char* program, size_t room) {
    FILE* file = fopen(name, "rb");
    const size_t size = file == NULL ? 0 : fread(program, 1, room, file);
    if (file != NULL) fclose(file);
    return size;
}

int main(int argc, char** argv) {
    static unsigned char program[65536];
    if (argc < 3) return 2;
    size_t size = read_program(argv[1], program, sizeof program);
    rtamt_fleet* fleet = NULL;
    rtamt_stream* stream = NULL;
    char message[200];
    if (rtamt_fleet_create(program, size, 10, 0.1, &fleet, message, sizeof message) != RTAMT_OK ||
        rtamt_stream_create(program, size, 10, 0.1, 1.0, RTAMT_GAPS_RESTART, &stream, message, sizeof message) !=
            RTAMT_OK) {
        puts(message);
        return 1;
    }
    rtamt_fleet_value values[2];
    if (two_cars(fleet, values) != RTAMT_OK) return 1;
    printf("%g %g\n", values[0].value, values[1].value);
    const int64_t keys[] = {7, 7, 7, 7};
    const double times[] = {1.0, 0.0, 3.0, 1.0}, speeds[] = {-1.0, 9.0, 16.0, 4.0};
    int32_t late[4];
    for (size_t i = 0; i < 4; i += 2)
        printf("%d late\n", take(stream, keys + i, times + i, speeds + i, 2, late));
    rtamt_stream_destroy(stream);
    rtamt_fleet_destroy(fleet);
    size = read_program(argv[2], program, sizeof program);
    if (rtamt_fleet_create(program, size, 10, 0.1, &fleet, message, sizeof message) != RTAMT_OK) {
        puts(message);
        return 1;
    }
    const int64_t cars[] = {101, 102, 102};
    const double then[] = {0.0, 0.0, 1.0}, fast[] = {20.0, 28.0, 33.0};
    if (print_verdicts(fleet, cars, then, fast, 3) != RTAMT_OK) return 1;
    rtamt_fleet_destroy(fleet);
    return 0;
}
"""


def test_the_functions_for_fleets_of_the_documentation(place: Path) -> None:
    page = (ROOT / "docs/how-to/fleet.md").read_text(encoding="utf-8")
    code = [block.text for block in blocks(page) if block.language == "c"]
    assert len(code) == 3
    (place / "fleets.c").write_text("".join(code) + FLEETS, encoding="utf-8")
    run("rtamt", "compile", "sqrt(speed) <= 5", "--period", "1s", "-o", place / "roots.rtamt")
    eager = "--fleet", "--period", "1s", "--verdict", "eager", "-o", place / "eager.rtamt"
    run("rtamt", "compile", "always[0:2](speed <= 30)", *eager)
    prefix = place / "prefix"
    (library,) = prefix.glob("lib*")
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
    flags = [f"-I{prefix / 'include'}", f"-L{library}", "-lrtamt"]
    run("cc", *warnings, place / "fleets.c", "-o", place / "fleets", *flags)
    said = run(place / "fleets", place / "roots.rtamt", place / "eager.rtamt", LD_LIBRARY_PATH=str(library))
    assert said == (
        "0.527864 -0.291503\n7: robustness 2 at 0 s\n0 late\n1 late\n"
        "102 at 0 s: violated at 1 s\n102 at 1 s: violated at 1 s\n"
    )


def test_a_c_program_finds_the_library_by_pkg_config(place: Path) -> None:
    if shutil.which("pkg-config") is None:
        pytest.skip("pkg-config is not installed")
    (moved,) = (place / "prefix").rename(place / "moved").glob("lib*")  # the file names no absolute path
    flags = run("pkg-config", "--cflags", "--libs", "rtamt", PKG_CONFIG_PATH=str(moved / "pkgconfig"))
    run("cc", "-std=c99", "-Wall", "-Werror", place / "watch.c", "-o", place / "watch", *flags.split())
    assert link(place / "watch")
    said = run(place / "watch", place / "spec.rtamt", LD_LIBRARY_PATH=str(moved))
    assert said == (place / "expected.txt").read_text("utf-8")
    assert run("pkg-config", "--modversion", "rtamt", PKG_CONFIG_PATH=str(moved / "pkgconfig")) == "1.0.0\n"
