"""The runtime that leaves with a program: the shared library on its own, and what it refuses."""

import subprocess
from dataclasses import replace
from itertools import pairwise

import pytest

import rtamt
from rtamt.c_api import header, library
from rtamt.compiler.program import Program, records_of
from tests.support import c_api
from tests.support.c_fleet import CFleet, RejectedError

RATIO = rtamt.parse("const float c = 1  always[0:3](x / y >= c)").compile()


def test_the_library_needs_the_system_alone():
    needed = subprocess.run(["ldd", library()], check=True, capture_output=True, text=True).stdout
    names = {line.split()[0].split("/")[-1].split(".")[0] for line in needed.splitlines()}
    assert names <= {"linux-vdso", "libc", "libm", "ld-linux-x86-64", "ld-linux-aarch64"}


def test_the_header_is_beside_the_library_and_is_c():
    check = ["gcc", "-std=c99", "-pedantic-errors", "-fsyntax-only", "-x", "c", header()]
    assert subprocess.run(check, check=False).returncode == 0


def test_no_damaged_program_is_taken():
    code = RATIO.to_bytes()
    for place, after in pairwise(range(0, len(code), 7)):
        damaged = code[:place] + bytes(b ^ 0x5A for b in code[place:after]) + code[after:]
        with pytest.raises(c_api.RefusedError, match="This is not a program that can be run: "):
            c_api.Monitor(damaged)


def test_a_window_that_no_memory_holds_is_refused_with_a_sentence():
    program = rtamt.parse("always[0:3](x)").compile()
    wider = tuple(i._replace(n=2**45) if i.opcode == "slide_min" else i for i in program.instructions)
    with pytest.raises(c_api.RefusedError) as refused:
        c_api.Monitor(replace(program, records=records_of(wider)).to_bytes())
    assert refused.value.args == (c_api.NO_MEMORY, "There is not enough memory.")


def test_a_constant_is_a_parameter_unless_it_bounds_an_interval():
    spec = rtamt.parse("const float c = 1  const float t = 2  always[0:t](x >= c and y >= c + 1 and y <= t)")
    program = spec.compile()
    assert {n: program.instructions[i].x for n, (i,) in program.metadata.parameters.items()} == {"c": 1.0}
    monitor = c_api.Monitor(program.to_bytes())
    monitor.set_parameter(0, -2.0)
    assert [monitor.step((0.0, 0.0))[0] for _ in range(3)][-1] == 1.0


BOOLEAN = "input bool p  parameter bool strict = false  historically[0:2](strict or p)"


def test_a_number_in_place_of_a_boolean_is_refused_as_in_python():
    spec = rtamt.parse(BOOLEAN, period="1s")
    program = spec.compile()
    assert Program.from_bytes(program.to_bytes()).metadata.booleans == {"p", "strict"}
    dense = rtamt.parse(BOOLEAN, time="dense", resolution="1s").compile()
    for value in (0.5, -1.0, 2.0, float("inf")):
        with pytest.raises(rtamt.TraceError, match=f"'p' is {value:.15g} at sample 0"):
            spec.monitor().update(0, p=value)
        monitor = c_api.Monitor(program.to_bytes())
        with pytest.raises(c_api.RefusedError) as refused:
            monitor.set_parameter(0, value)
        assert refused.value.args[1] == (
            f"The parameter 'strict' is {value:.15g}, and declared as bool: give 1 or 0."
        )
        for carried, give in (
            (program, lambda m, x: m.step([x])),
            (spec.compile(verdict="interval"), lambda m, x: m.step([x], 4)),
            (dense, lambda m, x: m.push([(0, 0, x)])),
        ):
            monitor = c_api.Monitor(carried.to_bytes())
            before = monitor.save()
            with pytest.raises(c_api.RefusedError) as refused:
                give(monitor, value)
            status, sentence = refused.value.args
            assert status == c_api.REFUSED
            assert sentence.startswith(f"'p' is {value:.15g} at ")
            assert sentence.endswith(", and declared as bool: give 1 or 0.")
            assert monitor.save() == before
            give(monitor, 1.0)


ENUMERATED = (
    "enum Mode { MANUAL, AUTO = 4 }  parameter Mode wanted = AUTO  input Mode mode  once(mode == wanted)"
)


def test_a_code_that_no_member_has_is_refused_as_a_parameter_as_in_python():
    spec = rtamt.parse(ENUMERATED, period="1s")
    programs = (
        spec.compile(),
        spec.compile(verdict="interval"),
        rtamt.parse(ENUMERATED, time="dense", resolution="1s").compile(),
    )
    for program in programs:
        assert Program.from_bytes(program.to_bytes()).metadata == program.metadata
        monitor = c_api.Monitor(program.to_bytes())
        before = monitor.save()
        for value in (7.0, 0.5, -4.0, float("inf")):
            with pytest.raises(rtamt.UsageError, match="which is no member of Mode"):
                spec.with_parameters(wanted=value)
            with pytest.raises(c_api.RefusedError) as refused:
                monitor.set_parameter(0, value)
            assert refused.value.args == (
                c_api.REFUSED,
                f"The parameter 'wanted' is {value:.15g}, and declared as Mode: give 0 (MANUAL) or 4 (AUTO).",
            )
            assert monitor.save() == before
        for value in (0.0, 4.0):
            monitor.set_parameter(0, value)


@pytest.mark.parametrize("mode", ["delayed", "eager", "interval"])
def test_a_number_in_place_of_a_boolean_is_refused_by_fleets(mode):
    spec = rtamt.parse("input bool p  input float x  historically[0:2](p or x > 0)", period="1s")
    fleet = CFleet(rtamt.Fleet(spec, 4, verdict=mode).compile(), 4)
    with pytest.raises(RejectedError) as refused:
        fleet.update([7, 8, 9], [0.0, 0.0, 0.0], {"p": [1.0, 0.5, 2.0], "x": [0.0, 0.5, 0.0]})
    assert refused.value.args == (
        c_api.REFUSED, "Key 8 at index 1 of the batch has 0.5 as 'p' at 0 s, which is Boolean: give 0 or 1.", 1,
    )  # fmt: skip
    assert len(fleet) == 0
    fleet.update([7, 8], [0.0, 0.0], {"p": [1.0, 0.0], "x": [0.0, 0.5]})
    assert len(fleet) == 2


def test_the_verdict_is_boolean_where_the_robustness_is_zero():
    known = {
        op: c_api.Monitor(rtamt.parse(f"x {op} 3").compile().to_bytes()).step((3.0,)) for op in (">=", ">")
    }
    assert known == {">=": [0.0, float("inf")], ">": [0.0, float("-inf")]}


def test_a_time_is_told_to_its_last_digit():
    monitor = c_api.Monitor(rtamt.parse("x / y >= 1").compile(period=1234567.8).to_bytes())
    monitor.step((1.0, 1.0))
    with pytest.raises(c_api.RefusedError, match=r"has no value at sample 1, time 1234567\.8 s:"):
        monitor.step((0.0, 0.0))


def test_messages_name_the_constant_that_may_have_another_value_by_now():
    monitor = c_api.Monitor(RATIO.to_bytes())
    with pytest.raises(c_api.RefusedError) as refused:
        monitor.step((0.0, 0.0))
    assert refused.value.args == (
        c_api.UNDEFINED,
        "'x / y' has no value at sample 0, time 0 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen.",
    )
    with pytest.raises(c_api.RefusedError) as refused:
        monitor.step((float("inf"), 1.0, 3.0))
    assert refused.value.args == (
        c_api.REFUSED,
        "Sample 0 has the wrong number of values: expected 2 (x, y), got 3.",
    )


def test_requirements_over_different_inputs_share_a_start_in_a_dense_program():
    spec = rtamt.parse("require A: once(x >= 3); require B: x >= y", time="dense", resolution="1s")
    program = spec.compile().to_bytes()
    message = (
        "'x' starts at time 1 s and 'y' at time 2 s, but the requirements of this program read different inputs and "
        "share one trace: start all inputs together, or compile each requirement alone."
    )
    for before, samples in (([(0, 1, 5.0)], [(1, 2, 4.0)]), ([], [(0, 1, 5.0), (1, 2, 4.0)])):
        monitor = c_api.Monitor(program)
        monitor.push(before)
        with pytest.raises(c_api.RefusedError) as refused:
            monitor.push(samples)
        assert refused.value.args == (c_api.REFUSED, message)
    monitor = c_api.Monitor(program)
    known = []
    for samples in ([(0, 1, 5.0)], [(0, 2, 1.0), (1, 1, 4.0)], [(1, 4, 0.0), (0, 4, 0.0)]):
        monitor.push(samples)
        known += zip(*(column.tolist() for column in monitor.last_output(4)), strict=True)
    result = spec.evaluate({"x": ([1.0, 2, 4], [5, 1, 0]), "y": ([1.0, 4], [4, 0])})
    assert known == result.requirements["B"].signal.points()
    alike = rtamt.parse(
        "require A: once(x >= y); require B: y >= x; require C: true", time="dense", resolution="1s"
    )
    monitor = c_api.Monitor(alike.compile().to_bytes())
    monitor.push([(0, 1, 5.0), (1, 2, 4.0)])  # one trace for all, which starts at 2 s
    monitor.finish()
    assert monitor.last_output(2)[0].tolist() == [2]
