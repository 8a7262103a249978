"""All checks of the requirements of a specification, and the report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis.bounded_checker import (
    LIMIT,
    SAMPLES,
    BoundedChecker,
    Conclusion,
    Part,
    implications,
    unbounded,
)
from rtamt.analysis.encoder import NotCoveredError
from rtamt.language.contents import variables
from rtamt.language.operators import STL
from rtamt.language.printing.printer import excerpt
from rtamt.language.value_types import WHOLE
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from fractions import Fraction
    from typing import Any

    from rtamt.specification import Specification


@dataclass(frozen=True)
class Analysis:
    """The answers about the requirements of one specification.

    ``samples``: the greatest length of traces. ``period``: of sampling, in seconds. ``conclusions``: in the order of
    the requirements. ``notes``: what the analysis does not cover, one sentence each.
    """

    samples: int
    period: Fraction
    conclusions: tuple[Conclusion, ...]
    notes: tuple[str, ...] = ()

    @property
    def findings(self) -> tuple[Conclusion, ...]:
        """The answers by which something is wrong with the requirements."""
        return tuple(each for each in self.conclusions if each.finding)

    @property
    def unanswered(self) -> tuple[Conclusion, ...]:
        """The queries without an answer."""
        return tuple(each for each in self.conclusions if each.holds is None)


def analyze(
    spec: Specification,
    *,
    samples: int = SAMPLES,
    limit: float = LIMIT,
    recordings: Mapping[str, Any] | None = None,
) -> Analysis:
    """Run all checks on the requirements of a specification.

    ``samples``: the greatest length of traces. ``limit``: seconds that one query may take. ``recordings``: data as
    :meth:`rtamt.Specification.evaluate` takes it, by name; implications that none of them triggers are findings.

    >>> import rtamt
    >>> from rtamt.analysis import analyze
    >>> spec = rtamt.parse('''
    ...     input float speed [m/s] in [0, 60]
    ...     require R1: always(speed <= 50)
    ...     require R2: always(speed > 70 -> eventually[0:5](speed <= 50))''')
    >>> for finding in analyze(spec, samples=20).findings:
    ...     print(finding)
    R2: it always holds: no counterexample up to 20 samples
    R2: it is vacuous, because 'speed > 70' is never true: no trace up to 20 samples makes it true
    """
    checker = BoundedChecker([spec], samples, limit)
    parts, notes = _split_covered(spec, checker)
    found: list[Conclusion] = []
    for part in parts:
        first = checker.satisfiable(part)
        found.append(first)
        if first.finding and checker.without_value(part):
            continue
        found += [checker.valid(part), *checker.vacuous(part)]
    satisfiable = [part for part in parts if not any(_is(each, "satisfiable", part) for each in found)]
    if len(satisfiable) > 1:
        together = checker.satisfiable(*satisfiable)
        found.append(together)
        if together.holds:
            found += checker.redundant(satisfiable)
    for part in parts if recordings else ():
        found += _in_recordings(part, recordings or {})
    return Analysis(samples, checker.period, tuple(found), tuple(notes))


def _is(conclusion: Conclusion, question: str, part: Part) -> bool:
    return conclusion.finding and conclusion.question == question and conclusion.names == (part.name,)


def _split_covered(spec: Specification, checker: BoundedChecker) -> tuple[list[Part], list[str]]:
    """Return the requirements that the analysis covers, and what it does not."""
    parts: list[Part] = []
    notes: list[str] = []
    endless: list[str] = []
    for name, one in spec.requirements.items():
        try:
            checker.require_covered(one.formula, one)
        except NotCoveredError as error:
            notes.append(f"{name}: {error.message}")
            continue
        parts.append(Part(name, one))
        if unbounded(one.formula):
            endless.append(name)
    whole = [
        name for name in _whole_numbers(spec) if name in variables(*(part.spec.formula for part in parts))
    ]
    return parts, [*notes, *unbounded_note(endless, checker.samples), *about_whole(whole)]


def unbounded_note(names: Sequence[str], samples: int) -> list[str]:
    """Return the note that requirements have unbounded operators, if some have."""
    if not names:
        return []
    have = "have" if len(names) > 1 else "has"
    return [
        f"{_join_names(names)} {have} unbounded operators: traces longer than {samples} samples are not covered"
    ]


def about_whole(names: Sequence[str]) -> list[str]:
    """Return the note that variables are declared as whole numbers, if some are."""
    if not names:
        return []
    are = "are whole numbers" if len(names) > 1 else "is a whole number"
    return [f"{_join_names(names)} {are}: traces have any number there, as recordings may"]


def _whole_numbers(spec: Specification) -> list[str]:
    return [each.name for each in spec.document.declarations if each.kind == "var" and each.type in WHOLE]


def _join_names(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _in_recordings(part: Part, recordings: Mapping[str, Any]) -> Iterator[Conclusion]:
    """Answer for each implication of a requirement whether some recording triggers it."""
    for condition in implications(part.spec.formula):
        spec = part.spec.with_formula(STL["eventually"](condition))
        where = [name for name, data in recordings.items() if spec.evaluate(data).satisfied]
        count = f"{len(recordings)} recording{'s' * (len(recordings) != 1)}"
        yield Conclusion(
            "triggered",
            (part.name,),
            bool(where),
            f"'{excerpt(condition)}' is true in {len(where)} of {count}"
            if where
            else f"it is vacuous on the given recordings: '{excerpt(condition)}' is never true in {count}",
            not where,
        )
