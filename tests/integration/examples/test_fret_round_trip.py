"""Lockheed Martin's challenge problems through FRET: what FRETish can express has equal verdicts when read again."""

from fractions import Fraction
from pathlib import Path

import pytest

import rtamt
from rtamt.interchange.fret.export import write_fret
from rtamt.interchange.fret.project import read_fret
from tests.integration.examples.requirements import lockheed_martin

FOLDER = Path(__file__).parents[3] / "examples" / "requirements" / "lockheed_martin"


@pytest.mark.parametrize("name", lockheed_martin.TRACES)
def test_verdicts_are_equal_on_the_traces_of_a_problem(name):
    spec, traces = rtamt.load(FOLDER / f"{name}.stl"), lockheed_martin.TRACES[name]
    written = write_fret(spec)
    again = read_fret(written.text, Fraction(1) if spec.period is None else Fraction(spec.period))
    assert again.rejected == ()
    assert again.converted == written.converted
    found = rtamt.parse(again.text).requirements
    for requirement in written.converted:
        for changed in traces.cases[requirement]:
            columns = traces.made(changed)
            before, after = (
                spec.requirements[requirement].evaluate(columns),
                found[requirement].evaluate(columns),
            )
            assert after.satisfied is before.satisfied


def test_most_requirements_are_expressible():
    found = [write_fret(rtamt.load(FOLDER / f"{name}.stl")) for name in lockheed_martin.TRACES]
    assert (sum(len(f.converted) for f in found), sum(len(f.rejected) for f in found)) == (68, 5)
