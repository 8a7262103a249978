"""The laws on random cases: ``python -m tests.laws.early.soak 1000000 [SEED]`` checks each on its share of so many.

A failure prints the seed of its case, which :data:`LAWS` reproduces: ``law(random.Random(seed), made)``.
"""

from __future__ import annotations

import sys
from collections import Counter
from random import Random
from typing import TYPE_CHECKING

from tests.laws.early import dense_laws, laws, specifications
from tests.laws.early.cases import ANYTHING, arrivals, case, dense_case, value
from tests.laws.early.definition import DEFINITION
from tests.laws.early.monitors import IMPLEMENTATIONS, PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.laws.early.definition import Implementation

    Law = Callable[[Random, Implementation], None]


def sound(rng: Random, made: Implementation) -> None:
    laws.sound(case(rng), made)


def narrowing(rng: Random, made: Implementation) -> None:
    laws.narrowing(case(rng), made)


def delayed(rng: Random, made: Implementation) -> None:
    laws.delayed(case(rng, exact=True), made)


def finished(rng: Random, made: Implementation) -> None:
    laws.finished(case(rng, exact=True), made)


def accepted(rng: Random, made: Implementation) -> None:
    laws.accepted(case(rng, exact=True, ranges=False, partial=True), made)


def as_defined(rng: Random, made: Implementation) -> None:
    laws.as_defined(case(rng), made)


def any_order(rng: Random, made: Implementation) -> None:
    drawn = case(rng)
    order = list(range(drawn.n))
    rng.shuffle(order)
    laws.any_order(drawn, made, order)


def tight(rng: Random, made: Implementation) -> None:
    drawn = case(rng, ranges=True, most=2, odd=False)
    laws.tight(drawn, made)


def fails_alike(rng: Random, made: Implementation) -> None:
    drawn = case(rng, partial=rng.random() < 0.7)
    order, lateness = list(range(drawn.n)), rng.choice((0, 0, drawn.n))
    if lateness:
        rng.shuffle(order)
    laws.fails_alike(drawn, made, order, lateness)


def eager(rng: Random, made: Implementation) -> None:
    laws.eager(case(rng), made)


def causes(rng: Random, made: Implementation) -> None:
    laws.causes(case(rng, exact=True, ranges=False), made)


def causation_as_defined(rng: Random, made: Implementation) -> None:
    unbounded = rng.random() < 0.5
    laws.causation_as_defined(case(rng, exact=True, ranges=False, unbounded=unbounded), made)


def dense_sound(rng: Random, made: Implementation) -> None:
    dense_laws.sound(dense_case(rng, unbounded=False), made)


def dense_narrowing(rng: Random, made: Implementation) -> None:
    dense_laws.narrowing(dense_case(rng, unbounded=False), made)


def dense_finished(rng: Random, made: Implementation) -> None:
    dense_laws.finished(dense_case(rng, exact=True, unbounded=False), made)


def dense_accepted(rng: Random, made: Implementation) -> None:
    dense_laws.accepted(dense_case(rng, exact=True, ranges=False, partial=True), made)


def dense_as_defined(rng: Random, made: Implementation) -> None:
    dense_laws.as_defined(dense_case(rng, unbounded=False), made)


def dense_start(rng: Random, made: Implementation) -> None:
    dense_laws.start(dense_case(rng), made)


def dense_late(rng: Random, made: Implementation) -> None:
    drawn = dense_case(rng, unbounded=False)
    dense_laws.late(drawn, made, arrivals(rng, drawn))


def dense_corrected(rng: Random, made: Implementation) -> None:
    drawn = dense_case(rng, unbounded=False)
    wrong = {
        (t, name): value(rng, *drawn.ranges.get(name, ANYTHING))
        for t, row in drawn.updates
        for name, known in row.items()
        if known is not None and known[0] == known[1] and rng.random() < 0.4
    }
    dense_laws.corrected(drawn, made, wrong)


def dense_fails_alike(rng: Random, made: Implementation) -> None:
    dense_laws.fails_alike(dense_case(rng, partial=rng.random() < 0.5), made)


def dense_tight(rng: Random, made: Implementation) -> None:
    dense_laws.tight(dense_case(rng, ranges=True, odd=False, unbounded=False, narrow=True), made)


def dense_eager(rng: Random, made: Implementation) -> None:
    dense_laws.eager(dense_case(rng), made)


def dense_causes(rng: Random, made: Implementation) -> None:
    dense_laws.causes(dense_case(rng, exact=True, ranges=False, unbounded=rng.random() < 0.3), made, rng)


def dense_causation_as_defined(rng: Random, made: Implementation) -> None:
    dense_laws.causation_as_defined(
        dense_case(rng, exact=True, ranges=False, unbounded=rng.random() < 0.3), made, rng
    )


def specification_bounds(rng: Random, made: Implementation) -> None:
    assert made.backend is not None
    specifications.bounds(rng, made.backend)


def specification_verdicts(rng: Random, made: Implementation) -> None:
    assert made.backend is not None
    specifications.verdicts(rng, made.backend)


def specification_as_defined(rng: Random, made: Implementation) -> None:
    assert made.backend is not None
    specifications.as_defined(rng, made.backend)


LAWS: list[Law] = [
    sound,
    narrowing,
    delayed,
    finished,
    accepted,
    as_defined,
    any_order,
    tight,
    fails_alike,
    eager,
    causes,
    causation_as_defined,
    dense_sound,
    dense_narrowing,
    dense_finished,
    dense_accepted,
    dense_as_defined,
    dense_start,
    dense_late,
    dense_corrected,
    dense_fails_alike,
    dense_tight,
    dense_eager,
    dense_causes,
    dense_causation_as_defined,
    specification_bounds,
    specification_verdicts,
    specification_as_defined,
]

#: Laws that compare an implementation with the definition, or with an evaluation.
COMPARISONS: list[Law] = [
    as_defined,
    fails_alike,
    causation_as_defined,
    dense_as_defined,
    dense_start,
    dense_corrected,
    dense_fails_alike,
    dense_causation_as_defined,
    specification_bounds,
    specification_verdicts,
    specification_as_defined,
]


def laws_of(made: Implementation) -> list[Law]:
    """Return the laws that an implementation must obey."""
    excluded = (
        COMPARISONS
        if made is DEFINITION
        else [dense_fails_alike, specification_as_defined]
        if made is PYTHON
        else []
    )
    return [law for law in LAWS if law not in excluded]


def main(count: int, first: int = 0) -> None:
    """Check every law for every implementation on its share of ``count`` cases, from seed ``first`` on."""
    pairs = [(law, made) for made in IMPLEMENTATIONS for law in laws_of(made)]
    checked: Counter[str] = Counter()
    for seed in range(first, first + count):
        law, made = pairs[seed % len(pairs)]
        try:
            law(Random(seed), made)  # noqa: S311 - no secret
        except laws.NothingToCheck:
            checked["without a value to check"] += 1
        except BaseException:
            print(f"{law.__name__} of {made.name}, seed {seed}", flush=True)
            raise
        else:
            checked[f"{law.__name__} of {made.name}"] += 1
    for name, cases in sorted(checked.items()):
        print(f"{cases:>9,}  {name}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
