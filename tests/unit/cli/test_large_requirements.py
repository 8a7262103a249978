"""Commands take work in proportion to the size of a requirement, which is counted in calls of Python functions."""

from __future__ import annotations

import sys

import pytest

SHAPES = {
    "conjunction": lambda n: " and ".join(f"always[0:{k % 9}](x >= {k - n})" for k in range(n)),
    "violated conjunction": lambda n: " and ".join(f"always[0:{k % 9}](x >= {k})" for k in range(n)),
    "definitions": lambda n: (
        "".join(f"p{k} = once[0:{k % 9}](x >= {-k});\n" for k in range(n))
        + " and ".join(f"p{k}" for k in range(n))
    ),
    "alternating chain": lambda n: (
        "p0 = x > 0;\n"
        + "".join(f"p{k} = (p{k - 1} or x > {k}) and x > {-k};\n" for k in range(1, n))
        + f"p{n - 1}"
    ),
    "nested windows": lambda n: (
        "p0 = x > 0;\n" + "".join(f"p{k} = always[0:1](p{k - 1});\n" for k in range(1, n)) + f"p{n - 1}"
    ),
    "nested until": lambda n: (
        "p0 = x > 0;\n"
        + "".join(f"p{k} = p{k - 1} until[0:1] x > {-k};\n" for k in range(1, n))
        + f"p{n - 1}"
    ),
}
SMALL = 80
READING = ("check", "explain")


def calls_of(run, *arguments, events=("call",)) -> int:
    count = 0

    def counted(_frame, event, _function):
        nonlocal count
        count += event in events

    sys.setprofile(counted)
    try:
        assert run(*arguments).code in (0, 1)
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("command", ["check", "explain", "info", "describe", "lint"])
def test_four_times_the_parts_need_about_four_times_the_calls(command, shape, run, write):
    recording = write("trace.csv", "time,x\n" + "".join(f"{k},{k % 7}\n" for k in range(20)))
    counts = []
    for size in (2, SMALL, 4 * SMALL):  # the first time, modules are loaded
        write("large.stl", SHAPES[shape](size))
        counts.append(calls_of(run, command, "large.stl", *([recording] if command in READING else [])))
    assert counts[2] < 4.8 * counts[1], counts


def test_four_times_the_requirements_need_about_four_times_the_calls(run, write):
    recording = write("trace.csv", "time,x\n" + "".join(f"{k},{k % 7}\n" for k in range(20)))
    counts = []
    for size in (2, SMALL, 4 * SMALL):
        write("many.stl", "".join(f"require R-{k}: x >= {k}\n" for k in range(size)))
        counts.append(calls_of(run, "check", "many.stl", recording))
    assert counts[2] < 4.8 * counts[1], counts


def test_four_times_the_comparisons_of_a_number_need_about_four_times_the_calls(run, write):
    counts = []
    for size in (2, SMALL, 4 * SMALL):
        write("comparisons.stl", " and ".join(f"x > {k}" for k in range(size)))
        counts.append(calls_of(run, "lint", "comparisons.stl", events=("call", "c_call")))
    assert counts[2] < 4.8 * counts[1], counts
