"""The hot paths need no more instructions than benchmarks/budget.toml grants, beyond an allowance of 5 %."""

import os
import shutil

import instructions
import pytest


@pytest.mark.timeout(600)  # 18 seconds, but on a busy machine many times that
def test_no_hot_path_needs_five_percent_more_instructions_than_its_budget():
    missing = [tool for tool in instructions.TOOLS if shutil.which(tool) is None]
    if missing and os.environ.get("CI") != "true":
        pytest.skip(f"{' and '.join(missing)} not found")
    budget = instructions.budget_of(instructions.environment(), instructions.budgets())
    if not budget:
        sentence = (
            f"no budget for {instructions.environment()}: record one with `make budget` on a good commit"
        )
        pytest.fail(sentence) if os.environ.get("CI") == "true" else pytest.skip(sentence)
    assert instructions.over_budget(instructions.count(), budget) == []


def test_a_path_beyond_the_allowance_is_named_with_both_counts():
    budget = {"step(x, y)": 1000.0, "parse": 2000.0}
    assert instructions.over_budget({"step(x, y)": 1050.0, "parse": 1900.0}, budget) == []
    assert instructions.over_budget({"step(x, y)": 1051.0, "parse": 1900.0}, budget) == [
        "step(x, y): 1051 instructions, 5.1% over its budget of 1000.0"
    ]


def test_another_python_has_the_budget_of_the_core_and_another_compiler_none():
    tables = {"GCC 12.2.0, CPython 3.11.7": {"core, a sample: x": 10.0, "step(x, y)": 1000.0}}
    budget = instructions.budget_of("GCC 12.2.0, CPython 3.13.1", tables)
    assert budget == {"core, a sample: x": 10.0}
    assert instructions.over_budget({"core, a sample: x": 10.4, "step(x, y)": 900.0}, budget) == []
    assert instructions.budget_of("GCC 13.1.0, CPython 3.11.7", tables) == {}


def test_a_path_without_a_budget_is_a_fault_like_a_budget_without_a_path():
    assert instructions.over_budget({"new": 1.0}, {"old": 1.0}) == [
        "the measured paths and those of the budget differ: new, old"
    ]


def test_instructions_of_foreign_libraries_and_of_calls_are_not_counted_twice(tmp_path):
    dump = tmp_path / "counts"
    dump.write_text(
        "events: Ir\nsummary: 99\n\nob=/usr/bin/python3\nfl=x.c\nfn=main\n12 5\n+3 7\n* 1\n14\n"
        "cob=/usr/lib/libc.so.6\ncfn=malloc\ncalls=2 0\n15 40\n16 2\nob=/usr/lib/libc.so.6\nfn=malloc\n1 40\n"
    )
    assert instructions.counted(dump) == 15
