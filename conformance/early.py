"""Writes `corpus/early.jsonl`: bounds, earliest verdicts and causation of traces that are known in part.

From the definition. Part of `python -m conformance.generate`. Formulas and traces are drawn as for the rest of the
corpus, with bounded future in discrete time; then samples become missing or uncertain. README.md describes the fields.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from conformance.cases import FOLDER, each, records, text
from conformance.trees import in_steps, tree
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.definitions.enclosures import Enclosure
from rtamt.language.parsing.parser import parse_formula
from rtamt.reference import dense_bounds, dense_causation, discrete_bounds, eager_verdicts
from rtamt.reference.discrete_bounds import ANYTHING, Knowledge
from rtamt.reference.discrete_causation import causation
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.early import causeless

if TYPE_CHECKING:
    from collections.abc import Iterator

    from conformance.generate import Drawing
    from rtamt.signals.outcomes import Causation

FILE = "early.jsonl"
DRAWN = 150  # cases a time domain
EXACT = 50  # cases more of each time domain whose samples are all known, for causation


@dataclass
class EarlyCase:
    """A formula, a trace that is known in part, and the answers; README.md says what each field holds."""

    id: str
    time: str
    formula: str
    step: str
    signals: dict[str, list[Any]]
    ranges: dict[str, list[float]]
    tree: dict[str, Any] = field(default_factory=dict)
    bounds: list[Any] = field(default_factory=list)
    verdicts: list[Any] = field(default_factory=list)
    causation: list[Any] = field(default_factory=list)

    @property
    def exact(self) -> bool:
        """Whether all samples are known, and nothing is of later ones."""
        samples = (sample for values in self.signals.values() for sample in values)
        known = (sample if self.time == "discrete" else sample[1] for sample in samples)
        return not self.ranges and all(isinstance(v, int | float) for v in known)

    @property
    def seconds(self) -> Fraction:
        """The sampling period, or the length of a tick."""
        return Fraction(self.step)

    def pair(self, name: str, value: Any) -> tuple[float, float]:
        """Return the bounds of a sample as it is written."""
        if value is None:
            low, high = self.ranges.get(name, ANYTHING)
            return low, high
        return (value[0], value[1]) if isinstance(value, list) else (value, value)


def read() -> list[EarlyCase]:
    """Return the cases of the file; raise :class:`CorpusError` where it is malformed."""
    stored = ("tree", "bounds", "verdicts", "causation")
    return [EarlyCase(**record) for _, record in records(FOLDER / FILE, EarlyCase, stored)]


def write(cases: list[EarlyCase]) -> None:
    """Write the file."""
    with (FOLDER / FILE).open("w", encoding="utf-8") as file:
        for case in cases:
            kept = each(asdict(case), text)
            file.write(json.dumps(kept, separators=(",", ":"), allow_nan=False, ensure_ascii=False) + "\n")


def answered(case: EarlyCase) -> EarlyCase:
    """Fill in the tree and the answers: from the definition."""
    formula = parse_formula(case.formula)
    case.tree = tree(in_steps(formula, case.seconds))
    if case.time == "discrete":
        columns = {}
        for name, values in case.signals.items():
            pairs = [case.pair(name, value) for value in values]
            columns[name] = Enclosure(*(np.array([pair[k] for pair in pairs], float) for k in (0, 1)))
        n = len(next(iter(case.signals.values())))
        ranges = {name: (low, high) for name, (low, high) in case.ranges.items()}
        known = Knowledge(columns, n, ranges, finished=True)
        stages = [known.until(k) for k in range(1, n + 1)] + [known]
        case.bounds = [_filled(discrete_bounds.bounds(formula, stage, case.seconds), n) for stage in stages]
        case.verdicts = [
            list(map(list, news)) for news in eager_verdicts.verdicts(formula, known, case.seconds)
        ]
        if case.exact and causeless(formula) is None:
            caused = (causation(formula, stage, case.seconds, 1)[0] for stage in stages[:-1])
            case.causation = list(map(_ends, caused))
        return case
    updates = updates_of(case)
    names = tuple(case.signals)
    limits = {name: (low, high) for name, (low, high) in case.ranges.items()}
    end = updates[-1][0]
    before: dense_bounds.DenseKnowledge | None = None
    has_causes = case.exact and causeless(formula) is None
    for k in range(1, len(updates) + 2):
        stage_ = eager_verdicts.after(updates[:k], names, limits, finished=k > len(updates))
        found = dense_bounds.bounds(formula, stage_, case.seconds)
        rows = [list(row) for row in zip(found.times, found.lower, found.upper, strict=True) if row[0] <= end]
        case.bounds.append(None if stage_.start is None else rows)
        if has_causes:
            event = (
                None
                if stage_.start is None
                else dense_causation.causation(formula, before, stage_, case.seconds)
            )
            case.causation.append(None if event is None else _ends(event.causes[0]))
            before = None if event is None else stage_
    told = eager_verdicts.dense_verdicts(formula, updates, names, case.seconds, limits, finished=True)
    case.verdicts = [[list(run) for run in eager_verdicts.runs(news)] for news in told]
    return case


def _ends(caused: Causation) -> list[float]:
    return [caused.violation + 0.0, caused.satisfaction + 0.0]  # no minus before a zero


def updates_of(case: EarlyCase) -> list[eager_verdicts.Update]:
    """Return the samples of a dense case in the order of their ticks."""
    ticks = sorted({t for samples in case.signals.values() for t, _ in samples})
    return [
        (
            tick,
            {
                name: case.pair(name, value)
                for name, samples in case.signals.items()
                for t, value in samples
                if t == tick
            },
        )
        for tick in ticks
    ]


def _filled(found: Enclosure, n: int) -> list[list[float]]:
    """Return the bounds at the n samples: the last entry is that of all later ones."""
    pairs = list(zip(found.lower.tolist(), found.upper.tolist(), strict=True))
    return [list(pairs[min(i, len(pairs) - 1)]) for i in range(n)]


def drawn(draw: Drawing, name: str, time: str, step: str, *, exact: bool) -> EarlyCase | None:
    """Draw a case; None where it has no answer. ``exact``: one that has causation."""
    formula = draw.nested(draw.random.choice((1, 2, 2, 3)))
    names = variables(formula)
    if not names or (time == "discrete" and unbounded_future(formula) is not None):
        return None
    if exact:
        case = _answered(EarlyCase(name, time, str(formula), step, draw.signals(names), {}))
        return case if case is not None and case.causation else None
    ranges = {each: [-3.5, 3.5] for each in names if draw.chance(3)}
    signals = draw.signals(names)
    for each_, samples in signals.items():
        for i, sample in enumerate(samples):
            value = sample if time == "discrete" else sample[1]
            if each_ in ranges and not -3 <= value <= 3:
                return None
            known = _known(draw, value)
            samples[i] = known if time == "discrete" else [sample[0], known]
    return _answered(EarlyCase(name, time, str(formula), step, signals, ranges))


def _answered(case: EarlyCase) -> EarlyCase | None:
    try:
        return answered(case)
    except EvaluationError:
        return None


def _known(draw: Drawing, value: float) -> Any:
    if draw.chance(6):
        return None
    return [value - 0.5, value + 0.5] if draw.chance(5) else value


def cases(drawing: Any, steps: tuple[str, ...], seed: int) -> Iterator[EarlyCase]:
    """Yield the cases; ``drawing`` makes a :class:`Drawing` of a seed, a time domain and a step."""
    for kind, time, count in (
        ("discrete", "discrete", DRAWN),
        ("dense", "dense", DRAWN),
        ("causation", "discrete", EXACT),
        ("dense_causation", "dense", EXACT),
    ):
        found = attempt = 0
        while found < count:
            attempt += 1
            step = steps[attempt % len(steps)]
            draw = drawing(f"{seed} early {kind} {attempt}", time, step)
            case = drawn(draw, f"early/{kind}/{found:03}", time, step, exact="causation" in kind)
            if case is not None:
                found += 1
                yield case
