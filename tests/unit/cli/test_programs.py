"""``rtamt compile``, ``rtamt info`` of what it wrote, and ``rtamt fmu``."""

import struct
import zipfile
import zlib
from pathlib import Path

import pytest

import rtamt

SPEC = "const float limit = 3  always[0:200ms](x >= limit)"

LISTING = (
    "%0   lag 0    input x\n"
    "%1   lag 0    const 3.0\n"
    "%2   lag 0    sub %0 %1\n"
    "%3   lag 2    slide_min %2 n=3  -> output\n"
    "%4   lag 0    holds_ge %0 %1\n"
    "%5   lag 2    slide_min %4 n=3  -> output\n"
)


def test_a_program_is_written_and_told_about(run):
    assert run("compile", SPEC, "--period", "100ms", "-o", "spec.rtamt") == (
        0,
        "spec.rtamt: 6 instructions, 496 bytes, discrete time\n",
        "",
    )
    facts, _, listing = run("info", "spec.rtamt").out.partition("program\n")
    assert facts == (
        "formula    always[0:200ms](x >= 3)\n"
        "variables  x\n"
        "parameters limit = 3\n"
        "outputs    robustness, verdict\n"
        "period     100 ms, discrete time\n"
        "horizon    200 ms\n"
    )
    assert listing.replace("\n  ", "\n").lstrip() == LISTING


def test_a_program_is_listed(run):
    assert run("compile", SPEC, "--period", "100ms", "--dump") == (0, LISTING, "")
    assert "slide_min %2 n=200000000" in run("compile", SPEC, "--time", "dense", "--dump").out


def test_what_is_said_of_a_damaged_program(run, tmp_path):
    run("compile", SPEC, "--period", "100ms", "-o", "spec.rtamt")
    file = tmp_path / "spec.rtamt"
    code = file.read_bytes()
    file.write_bytes(code[:-1])
    assert run("info", "spec.rtamt").err == (
        f"rtamt: spec.rtamt: this is not a program that can be read: it has {len(code) - 1} bytes where its header "
        f"promises {len(code)}\n"
    )
    file.write_bytes(code[:50] + b"!" + code[51:])
    assert run("info", "spec.rtamt").err == (
        "rtamt: spec.rtamt: this is not a program that can be read: its checksum does not match, so it was damaged "
        "on the way\n"
    )
    assert run("info", "spec.rtamt", "--json").code == 2


def resealed(code, found, put):
    """Return a program with one number in another's place, and the checksum that belongs to it."""
    assert code.count(found) > 0
    body = code[:-4].replace(found, put)
    return body + struct.pack("<I", zlib.crc32(body))


@pytest.mark.parametrize(
    ("time", "width", "limits"), [("discrete", 3, "1 to 2^48"), ("dense", 200_000_000, "0 to 2^62")]
)
def test_a_resealed_program_of_an_impossible_width_is_not_listed(run, tmp_path, time, width, limits):
    run(
        "compile",
        SPEC,
        *(["--period", "100ms"] if time == "discrete" else ["--time", "dense"]),
        "-o",
        "huge.rtamt",
    )
    file = tmp_path / "huge.rtamt"
    file.write_bytes(resealed(file.read_bytes(), struct.pack("<q", width), struct.pack("<q", 2**62 + 1)))
    assert run("info", "huge.rtamt") == (
        2,
        "",
        "rtamt: huge.rtamt: this is not a program that can be run: instruction 3 (slide_min) has the width "
        f"{2**62 + 1}, outside {limits}\n",
    )


def test_nothing_to_do_and_nowhere_to_write(run):
    assert run("compile", SPEC) == (
        2,
        "",
        "rtamt: nothing to do: give -o FILE to write the program, or --dump to list it\n",
    )
    assert run("compile", SPEC, "--period", "100ms", "-o", "nowhere/x.rtamt") == (
        2,
        "",
        "rtamt: cannot write 'nowhere/x.rtamt': No such file or directory\n",
    )


def test_a_unit_is_written(run, tmp_path):
    answer = run("fmu", SPEC, "--period", "100ms", "-o", "limit.fmu", "--fmi", "3")
    assert answer.code == 0
    assert answer.out.startswith("limit.fmu: FMI 3.0, co-simulation, ")
    with zipfile.ZipFile(tmp_path / "limit.fmu") as archive:
        assert "resources/program.rtamt" in archive.namelist()
    unbounded = run("fmu", "always(x <= 3)", "-o", "limit.fmu")
    assert unbounded.code == 2
    assert unbounded.err.startswith("rtamt: 'always' without an upper bound needs the whole future")


def test_a_program_of_bounds_is_compiled_for_unbounded_future(run):
    answer = run("compile", "always(x >= 3)", "--verdict", "interval", "-o", "bounds.rtamt")
    assert (answer.code, answer.err) == (0, "")
    listed = run("info", "bounds.rtamt").out
    assert "outputs    lower, upper, verdict, decided_since" in listed
    assert run("compile", "always(x >= 3)", "-o", "delayed.rtamt").code == 2
    dense = run("compile", "always(x >= 3)", "--verdict", "interval", "--time", "dense", "-o", "dense.rtamt")
    assert "bounds at the start of the trace are compiled for discrete time" in dense.err


def test_a_unit_of_bounds_is_exported_for_unbounded_future(run):
    assert run("fmu", "always(x >= 3)", "--verdict", "interval", "-o", "bounds.fmu").code == 0


def test_a_program_of_a_fleet_is_that_of_the_api(run):
    options = "--fleet", "--time", "dense", "--verdict", "causation", "-o", "fleet.rtamt"
    answer = run("compile", "always[0:2](x >= 3)", *options)
    program = rtamt.Fleet(rtamt.parse("always[0:2](x >= 3)"), 1, time="dense", verdict="causation").compile()
    assert answer == (0, f"fleet.rtamt: a fleet, {len(program)} bytes, dense time, causation verdicts\n", "")
    assert Path("fleet.rtamt").read_bytes() == program


def test_what_only_fleets_or_only_monitors_have_is_an_error(run):
    assert run("compile", SPEC, "--verdict", "eager", "-o", "x.rtamt") == (
        2,
        "",
        "rtamt: --verdict eager is compiled for fleets; add --fleet\n",
    )
    for option in ("--dump", "--worst-case"):
        answer = run("compile", SPEC, "--period", "100ms", "--fleet", option, "-o", "x.rtamt")
        assert answer.err == f"rtamt: {option} is for programs of one monitor; leave it or --fleet out\n"


@pytest.mark.parametrize("command", ["compile", "fmu"])
def test_a_name_with_bytes_that_are_not_utf_8_is_rejected_as_such(run, command):
    assert run(command, '"x\udcff" >= 3', "--period", "1s", "-o", "spec.out") == (
        2,
        "",
        "rtamt: a program cannot contain '\\udcff', which UTF-8 lacks: correct the name in '\"x\\udcff\" >= 3'\n",
    )
    assert not Path("spec.out").exists()


@pytest.mark.parametrize("mode", ["delayed", "eager", "interval"])
def test_programs_of_fleets_reject_such_a_name_by_the_same_sentence(run, mode):
    assert run(
        "compile", '"x\udcff" >= 3', "--period", "1s", "--fleet", "--verdict", mode, "-o", "spec.out"
    ) == (
        2,
        "",
        "rtamt: a program cannot contain '\\udcff', which UTF-8 lacks: correct the name in 'x\\udcff'\n",
    )
    assert not Path("spec.out").exists()
