"""The long run of the laws of early verdicts: what it counts, and how it goes on after a failure."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from tests.laws.early import laws, soak


def passes(_rng, _made):
    pass


def has_nothing(_rng, _made):
    raise laws.NothingToCheck


def fails(_rng, _made):
    raise AssertionError("it never holds\nand more about it")


@pytest.fixture(autouse=True)
def three_laws(monkeypatch):
    definition = soak.PAIRS[0][1]
    monkeypatch.setattr(soak, "PAIRS", [(law, definition) for law in (passes, has_nothing, fails)])
    monkeypatch.setattr(soak, "PART", 6)
    monkeypatch.setattr(soak, "ProcessPoolExecutor", ThreadPoolExecutor)


def test_cases_without_anything_to_check_do_not_count():
    part = soak.check_part(12)
    assert dict(part.checked) == {"passes of definition": 2}
    assert part.void == 2


def test_each_failure_is_reported_with_its_number_and_the_others_go_on():
    assert soak.check_part(12).failures == [
        "case 14: fails of definition: AssertionError: it never holds",
        "case 17: fails of definition: AssertionError: it never holds",
    ]


def test_the_number_of_a_failure_reproduces_it():
    with pytest.raises(AssertionError, match="it never holds"):
        soak.check(14)


def test_all_cases_count_until_enough_had_something_to_check(capsys):
    # Of each part of six cases two pass and two fail; the third part is enough, and the fourth has begun by then.
    assert soak.main(5, 12, 1) == 8
    *failures, summary, passed = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in failures] == [f"case {n}" for n in range(14, 36, 3)]
    assert summary.startswith("8 cases checked, 8 without anything to check, 8 failures; ")
    assert summary.endswith("; next: --from 36")
    assert passed.split() == ["8", "passes", "of", "definition"]
