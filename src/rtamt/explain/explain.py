"""A formula and a recording to an explanation: the critical point and the implicant."""

from __future__ import annotations

from itertools import islice
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError
from rtamt.explain.critical import Point, Walk
from rtamt.explain.description import Description
from rtamt.explain.explanation import CriticalPoint, Explanation, Listed
from rtamt.explain.forcing import Forcing
from rtamt.explain.intervals import Interval, Intervals
from rtamt.explain.minimise import minimal
from rtamt.explain.moves import Moves
from rtamt.explain.necessary import Needs
from rtamt.explain.propagate import Demands
from rtamt.explain.signals import Signals, has_share, near, truths
from rtamt.explain.wording import cause, predicate_text, summary
from rtamt.language.formula import Apply
from rtamt.language.printing.printer import to_text
from rtamt.language.printing.writing import PAGE
from rtamt.language.records import Tense, Window
from rtamt.lazy.modules import np
from rtamt.rewrite.semantics import boolean, no_verdict
from rtamt.rewrite.structure import CHOOSING, Structure, opcode, reaches, window_of
from rtamt.signals.instants import Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rtamt.engine import TimeAxis
    from rtamt.language.formula import Formula
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace

#: How many places are tried for one that overturns the verdict alone.
_TRIED = 64


def explain(
    formula: Formula,
    recording: DomainTrace,
    *,
    backend: str = "cpp",
    at: Any = None,
    text: str | None = None,
    semantics: Callable[[Formula], Formula] = lambda predicate: predicate,
    signal: Signal | None = None,
) -> Explanation:
    """Explain a formula's verdict and robustness at an instant (by default the first).

    ``recording``: normalised, as a result holds it. ``at``: a time in the caller's format. ``text``: from
    which the formula was read, to quote predicates as they were written. ``semantics`` gives the
    formula whose value counts as that of a predicate. ``signal``: the robustness, if it has been evaluated; then less
    is to be. Raises :class:`UsageError` if ``at`` is not in the recording.
    """
    return _Explainer(formula, recording, backend, text, semantics, at, signal).explanation()


class _Explainer:
    """One formula over one recording, at one instant."""

    def __init__(
        self,
        formula: Formula,
        recording: DomainTrace,
        backend: str,
        text: str | None,
        semantics: Callable[[Formula], Formula],
        at: Any,
        signal: Signal | None,
    ) -> None:
        (formula,) = recording.domain.ground(formula)
        self._formula = formula
        self._text = text
        self._line: TimeAxis = recording.domain.part("time_axis")(recording, backend)
        self._dense = recording.domain.continuous
        self._structure = Structure.of(formula, self._line.period if self._dense else None)
        leaves = self._structure.leaves
        predicates = [leaf.formula for leaf in leaves.values()]
        self._values = self._measure([semantics(predicate) for predicate in predicates])
        try:
            self._truth = self._measure([boolean(predicate) for predicate in predicates])
        except EvaluationError as error:
            raise no_verdict(error) from error
        self._cell = 0 if at is None else self._line.cell(at)
        # What the formula reads at the instant: nothing else is evaluated.
        behind, ahead = reaches(self._structure.order, self._line.period)[self._structure.core]
        window = self._cell - behind, self._cell + ahead + 1
        read = {name: near(steps, *window) for name, steps in self._values.items()}
        holds = {name: near(steps, *window) for name, steps in self._truth.items()}
        value = None  # to look for; it need not be the robustness
        if signal is not None and self._dense and has_share(self._structure.order):
            place = 1
            if self._cell:
                place = np.searchsorted(
                    signal.times, recording.times_at(np.array([self._cell])), side="right"
                )[0]
            value = float(signal.values[place - 1])
        self._signals = Signals(self._structure, self._line, read, value)
        self._holds = truths(self._structure.order, self._line, holds)
        self._robustness = self._signals.at(self._structure.core, self._cell)
        self._moves = Moves(self._structure, self._line, read, self._signals, self._cell, dense=self._dense)
        self._walk = Walk(self._signals, self._line.period, self._line.end)

    def _measure(self, formulas: list[Formula]) -> dict[str, StepFunction]:
        """Evaluate a formula for each leaf; return the values by the leaf's name."""
        steps = self._line.measured(formulas) if formulas else []
        return dict(zip(self._structure.leaves, steps, strict=True))

    def explanation(self) -> Explanation:
        cell, robustness = self._cell, self._robustness
        satisfied = cell in self._holds[self._structure.core]
        implicant = self._implicant(satisfied=satisfied)
        critical, point = self._critical(implicant)
        description = Description(self._formula, self._text, self._structure, self._line, self._values, cell)
        critical, source = description.with_source(critical, point)
        stretches = Listed(len(implicant), lambda k: description.stretch(implicant[k], satisfied=satisfied))
        text = to_text(self._formula, limit=PAGE)
        violation = None
        if not satisfied and cell == 0:
            violation = self._line.time(self._violated())
        show = self._line.show
        return Explanation(
            text,
            self._line.time(cell),
            satisfied,
            robustness,
            violation,
            critical,
            Listed(len(stretches), lambda k: stretches[k][0]),
            summary(
                text,
                "satisfied" if satisfied else "violated",
                robustness,
                show(cell) if cell else None,
                None if violation is None else show(self._line.later(violation)),
                (critical, show(point), source),
                caused=bool(stretches),
            ),
            Listed(len(stretches), lambda k: cause(*stretches[k])),
            _rank(implicant, point),
        )

    def _violated(self) -> int:
        """Return the cell at which the formula, violated at the first one, is so: see ``offline.first_violation``."""
        found: list[int] = []
        parts: list[tuple[Formula, Formula]] = [(self._formula, self._structure.core)]
        met: set[tuple[Formula, Formula]] = set()
        while parts:
            written, node = part = parts.pop()
            if part in met:
                continue
            met.add(part)
            if isinstance(written, Apply) and isinstance(node, Apply) and written.op.kernel == node.op.kernel:
                if opcode(node) == CHOOSING[0]:
                    parts += zip(written.args, node.args, strict=True)
                    continue
                if node.op.kernel == Window(CHOOSING[0]) and node.op.tense is Tense.FUTURE:
                    first, last = window_of(node, self._line.period)
                    window = Cells.of([(first, min(last + 1, self._line.end))])
                    found += (window - self._holds[node.args[0]]).starts[:1].tolist()
                    continue
            if 0 not in self._holds[node]:
                found.append(0)
        return min(found)

    # ---- the critical point ------------------------------------------------------------------------

    def _critical(self, implicant: Intervals) -> tuple[CriticalPoint, int]:
        """Return the critical point, and its cell.

        Where several places have the value of the robustness it is, if there is one, a place that overturns
        the verdict alone; such a place is in every implicant.
        """
        walked = self._walk.down(self._structure.core, self._cell)
        first = self._describe(walked)
        if overturns(first[0]):
            return first
        tried = self._moving(walked) if walked.name else None
        places = islice(self._places(implicant), _TRIED)
        found = self._alone([point for point in places if self._moving(point) != tried])
        return first if found is None else self._describe(found)

    def _alone(self, points: Sequence[Point]) -> Point | None:
        """Return the first of some places that overturns the verdict alone.

        Where all together do not, none does; so most are excluded at once.
        """
        if not points:
            return None
        if not self._moves.overturn(list(map(self._moving, points))):
            return None
        if len(points) == 1:
            return points[0]
        half = len(points) // 2
        return self._alone(points[:half]) or self._alone(points[half:])

    def _places(self, implicant: Intervals) -> Iterator[Point]:
        """Yield the places of an implicant that have the value of the robustness."""
        found: list[tuple[int, int, int]] = []
        for (name, sign), numbers in implicant.numbers():
            begins, stops = implicant.starts[numbers], implicant.ends[numbers]
            starts, ends = self._values[name].stretches(sign * self._robustness)
            firsts = np.searchsorted(ends, begins, side="right")
            lasts = np.searchsorted(starts, stops, side="left")
            for which in np.flatnonzero(firsts < lasts).tolist():
                for start, end in zip(
                    starts[firsts[which] : lasts[which]].tolist(),
                    ends[firsts[which] : lasts[which]].tolist(),
                    strict=True,
                ):
                    inside = max(start, int(begins[which])), min(end, int(stops[which]))
                    found.append((int(numbers[which]), *inside))
        for number, start, end in sorted(found):
            # In dense time a value changes on its whole segment, in discrete time sample by sample.
            cells = (start,) if self._dense else range(start, end)
            name, sign = implicant.literals[implicant.of[number]]
            yield from (Point(there, sign, name) for there in cells)

    def _describe(self, point: Point) -> tuple[CriticalPoint, int]:
        """Return a place that has the value of the robustness as a critical point, and its cell."""
        start, end = point.cell, point.cell + 1
        value = point.sign * self._robustness
        lowest = highest = self._robustness
        words, leaf = None, None
        decided_by = point.decided_by
        if point.name:
            leaf = self._structure.leaves[point.name]
            value = self._values[point.name].at(point.cell)
            words = predicate_text(leaf.formula, self._text)
            decided_by = "constant" if leaf.fixed else "predicate"
        if leaf is not None and not leaf.fixed:
            moving = self._moving(point)
            start, end = moving.start, moving.end
            lowest, highest = (self._moves.extreme(moving, toward) for toward in (-inf, inf))
        found = CriticalPoint(
            words,
            None if leaf is None else leaf.formula,
            self._line.time(point.cell),
            self._line.time(start),
            self._line.time(end) if self._dense else self._line.time(point.cell),
            value,
            point.sign,
            lowest,
            highest,
            decided_by,
        )
        return found, point.cell

    def _moving(self, point: Point) -> Interval:
        """Return the cells on which a value moves: in dense time those of its segment."""
        cells = self._values[point.name].around(point.cell) if self._dense else (point.cell, point.cell + 1)
        return Interval(*cells, point.name, point.sign)

    # ---- the implicant -----------------------------------------------------------------------------

    def _implicant(self, *, satisfied: bool) -> Intervals:
        period, end = self._line.period, self._line.end
        given = (self._structure, self._holds, self._signals, self._walk, period, end)
        demands = Demands(*given, dense=self._dense)
        here = Cells.of([(self._cell, self._cell + 1)])
        demands.ask(here, satisfied=satisfied)
        fixed = {
            leaf.name: _infinite(self._truth[leaf.name])
            for leaf in self._structure.leaves.values()
            if leaf.fixed
        }
        forcing = Forcing(self._structure, demands, self._line, fixed)
        candidates = Intervals.asked_in(demands)
        needs = Needs(*given, dense=self._dense).given(forcing.support(candidates))
        needs.ask(here, satisfied=satisfied)
        found = minimal(candidates, needs, forcing)
        places = {name: i for i, name in enumerate(self._structure.leaves)}
        signs, names = (
            np.array([key(literal_) for literal_ in found.literals], np.int64)[found.of]
            for key in (lambda literal_: literal_[1], lambda literal_: places[literal_[0]])
        )
        return found.take(np.lexsort((signs, found.starts, names)))


def overturns(point: CriticalPoint) -> bool:
    """Return whether the verdict falls where the critical value alone moves far enough."""
    robustness = point.polarity * point.value
    return point.lowest < 0 if robustness > 0 else point.highest > 0 if robustness < 0 else True


def _rank(implicant: Intervals, point: int) -> tuple[int, ...]:
    """Return the numbers of the intervals: of each predicate the closest to a cell, then the others, closest first."""
    distances = np.maximum(implicant.starts - point, point - implicant.ends + 1).clip(0)
    order = np.argsort(distances, kind="stable")
    closest = np.zeros(len(order), bool)
    for _, numbers in implicant.take(order).numbers():
        closest[numbers[0]] = True
    return tuple(np.concatenate((order[closest], order[~closest])).tolist())


def _infinite(steps: StepFunction) -> StepFunction:
    """Return +inf where a function is positive, and -inf elsewhere."""
    return two_valued(steps.positive(), inf, -inf, steps.end)
