"""The laws on random cases: ``python -m tests.laws.early.soak 1000000`` checks each on its share of so many.

Cases are numbered, and a number determines its case: the law, the implementation, and the seed of all that is drawn.
``--from NUMBER`` goes on where another run ended, which its progress reports; ``--case NUMBER`` repeats a failure with
its traceback. Only cases with something to check count: others have an operation without a value, or are outside the
class of their law.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
import traceback
from collections import Counter, deque
from concurrent.futures import ProcessPoolExecutor
from itertools import count, islice
from random import Random
from typing import TYPE_CHECKING, NamedTuple

from tests.laws.early import dense_failures, dense_laws, engines, laws, reports, specifications
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


def late(rng: Random, made: Implementation) -> None:
    drawn = case(rng)
    order = sorted(range(drawn.n), key=lambda i: i + rng.randint(0, 3))
    lateness = max(max(order[: k + 1]) - i for k, i in enumerate(order))
    laws.late(drawn, made, order, lateness + rng.choice((0, 0, 1, 3)))


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


def engines_agree(rng: Random, _made: Implementation) -> None:
    engines.agree(rng, case(rng, odd=rng.random() < 0.2))


def read_seldom(rng: Random, _made: Implementation) -> None:
    engines.read_seldom(rng, case(rng, partial=rng.random() < 0.3, odd=rng.random() < 0.2))


def dense_read_seldom(rng: Random, _made: Implementation) -> None:
    engines.dense_read_seldom(rng, dense_case(rng, partial=rng.random() < 0.3))


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
    dense_failures.alike(dense_case(rng, partial=rng.random() < 0.5), made)


def dense_late_fails_alike(rng: Random, made: Implementation) -> None:
    drawn = dense_case(rng, partial=rng.random() < 0.8)
    dense_failures.late_alike(drawn, made, arrivals(rng, drawn))


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


def reports_as_defined(rng: Random, made: Implementation) -> None:
    assert made.backend is not None
    reports.as_defined(rng, made.backend)


LAWS: list[Law] = [
    sound,
    narrowing,
    delayed,
    finished,
    accepted,
    as_defined,
    any_order,
    late,
    tight,
    fails_alike,
    eager,
    causes,
    causation_as_defined,
    engines_agree,
    read_seldom,
    dense_sound,
    dense_narrowing,
    dense_finished,
    dense_accepted,
    dense_as_defined,
    dense_start,
    dense_late,
    dense_corrected,
    dense_fails_alike,
    dense_late_fails_alike,
    dense_read_seldom,
    dense_tight,
    dense_eager,
    dense_causes,
    dense_causation_as_defined,
    specification_bounds,
    specification_verdicts,
    specification_as_defined,
    reports_as_defined,
]

#: Laws that compare an implementation with the definition, with an evaluation, or parts of the engine.
COMPARISONS: list[Law] = [
    as_defined,
    late,
    fails_alike,
    causation_as_defined,
    engines_agree,
    read_seldom,
    dense_as_defined,
    dense_start,
    dense_corrected,
    dense_fails_alike,
    dense_late_fails_alike,
    dense_read_seldom,
    dense_causation_as_defined,
    specification_bounds,
    specification_verdicts,
    specification_as_defined,
    reports_as_defined,
]


def laws_of(made: Implementation) -> list[Law]:
    """Return the laws that an implementation must obey."""
    excluded = (
        COMPARISONS
        if made is DEFINITION
        else [
            dense_fails_alike,
            dense_late_fails_alike,
            specification_as_defined,
            reports_as_defined,
            engines_agree,
            read_seldom,
            dense_read_seldom,
        ]
        if made is PYTHON
        else []
    )
    return [law for law in LAWS if law not in excluded]


PAIRS = [(law, made) for made in IMPLEMENTATIONS for law in laws_of(made)]

#: Cases that a process checks at a time.
PART = 10 * len(PAIRS)
#: Seconds between two lines of progress.
PAUSE = 30.0


class Part(NamedTuple):
    """What became of the cases of a part: how many had something to check, by law; how many had not; failures."""

    checked: Counter[str]
    void: int
    failures: list[str]


def check(number: int) -> str | None:
    """Check a case; return the name of its law and of its implementation, or None where there is nothing to check."""
    law, made = PAIRS[number % len(PAIRS)]
    try:
        law(Random(number), made)
    except laws.NothingToCheck:
        return None
    return f"{law.__name__} of {made.name}"


def check_part(first: int) -> Part:
    """Check the cases of a part, all of them, whether some fail or not."""
    part = Part(Counter(), 0, [])
    for number in range(first, first + PART):
        try:
            checked = check(number)
        except Exception as error:  # noqa: BLE001 - whatever a law meets is its failure
            law, made = PAIRS[number % len(PAIRS)]
            shown = traceback.format_exception_only(error)[-1].splitlines()[0]
            part.failures.append(f"case {number}: {law.__name__} of {made.name}: {shown}")
            continue
        if checked is None:
            part = part._replace(void=part.void + 1)
        else:
            part.checked[checked] += 1
    return part


def main(wanted: int, first: int, workers: int) -> int:
    """Check cases from number ``first`` on until ``wanted`` had something to check; return how many failed."""
    checked: Counter[str] = Counter()
    void, failures, begin = 0, 0, time.perf_counter()
    said = begin
    with ProcessPoolExecutor(workers) as pool:
        numbers = count(first, PART)
        # In the order of their numbers: all before the next one are done.
        running = deque((n, pool.submit(check_part, n)) for n in islice(numbers, 2 * workers))
        while running:
            number, future = running.popleft()
            part = future.result()
            checked += part.checked
            void += part.void
            failures += len(part.failures)
            print(*part.failures, sep="\n", end="\n" * bool(part.failures), flush=True)
            total = checked.total()
            if total < wanted:
                after = next(numbers)
                running.append((after, pool.submit(check_part, after)))
            now = time.perf_counter()
            if now - said > PAUSE or not running:
                said, rate = now, total / (now - begin)
                rest = max(0.0, (wanted - total) / rate) if rate else float("inf")
                print(
                    f"{total:,} cases checked, {void:,} without anything to check, {failures:,} failures; "
                    f"{rate:.0f} a second, {rest / 60:.0f} min to go; next: --from {number + PART}",
                    flush=True,
                )
    for name, cases in sorted(checked.items()):
        print(f"{cases:>9,}  {name}")
    return failures


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description="check the laws of bounds and early verdicts on random cases"
    )
    parser.add_argument(
        "wanted", type=int, nargs="?", default=1_000_000, help="cases with something to check"
    )
    parser.add_argument("--from", type=int, default=0, dest="first", help="the number of the first case")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--case", type=int, help="check the case of this number alone")
    options = parser.parse_args()
    if options.case is not None:
        print(check(options.case) or "nothing to check")
        sys.exit(0)
    sys.exit(1 if main(options.wanted, options.first, options.workers) else 0)
