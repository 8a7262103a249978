"""The formula of every form of FRETish sentence holds where the sentence does, and is that sentence again."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import product

import pytest

import rtamt
from rtamt.interchange.fret.english import sentence_of
from rtamt.interchange.fret.formalize import TIMINGS
from rtamt.interchange.fret.project import read_fret
from tests.oracle import fretish

SCOPES = {
    "": ("", False),
    "in m mode": ("in", False),
    "when not in m mode": ("notin", False),
    "before m": ("before", False),
    "after mode m": ("after", False),
    "only while m": ("in", True),
    "only before m": ("before", True),
    "only after m": ("after", True),
}
WORDS = {"next": "at the next timepoint", "until": "until s", "before": "before s"}


def _sentence(scope: str, condition: str, timing: str, samples: int) -> str:
    when = f"{condition} c" if condition else ""
    words = f"{timing} {samples} ticks" if timing in ("within", "for", "after") else WORDS.get(timing, timing)
    return " ".join(f"{scope} {when} the pump shall {words} satisfy r".split())


@pytest.mark.parametrize("timing", TIMINGS)
def test_every_form_of_sentence_means_what_fret_says(timing: str) -> None:
    rng = random.Random(timing)
    for (scope, (name, only)), condition in product(SCOPES.items(), ("", "when", "whenever")):
        samples = rng.randint(0, 3)
        text = _sentence(scope, condition, timing, samples)
        spec = rtamt.parse(read_fret(f"R: {text}").text)
        for _ in range(12):
            length = rng.randint(1, 8)
            m, c, r, s = ([rng.random() < p for _ in range(length)] for p in (0.4, 0.5, rng.random(), 0.3))
            expected = fretish.holds(
                timing, r, scope=name, mode=m, only=only, condition=c if condition else None,
                holding=condition == "whenever", stop=s, samples=samples,
            )  # fmt: skip
            data = {"time": list(range(length)), "m": m, "c": c, "r": r, "s": s}
            found = spec.evaluate(data)
            assert found.satisfied == expected, (text, str(spec.formula), data)


@pytest.mark.parametrize("timing", TIMINGS)
def test_a_sentence_that_is_read_is_written_with_the_same_meaning(timing: str) -> None:
    for scope, condition in product(SCOPES, ("", "when", "whenever")):
        text = _sentence(scope, condition, timing, 2)
        formula = rtamt.parse(read_fret(f"R: {text}").text).formula
        again = sentence_of(formula, "pump", Fraction(1))
        assert again.exact
        assert str(rtamt.parse(read_fret(f"R: {again.sentence}").text).formula) == str(formula), (
            again.sentence
        )
