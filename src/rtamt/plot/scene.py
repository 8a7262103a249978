"""The contents of a plot as data: signals, sub-formulas with their values, the explanation."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from rtamt.engine import Evaluators
from rtamt.errors import UsageError
from rtamt.explain.wording import predicate_text
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Var
from rtamt.language.records import Bounds, Fixity
from rtamt.language.value_types import value_names
from rtamt.lazy.dataclasses import dataclass
from rtamt.plot.band import Band, band
from rtamt.plot.lines import Line, Range, ranges
from rtamt.plot.panels import groups
from rtamt.plot.x_axis import XAxis, visible
from rtamt.rewrite.truth import is_predicate
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.explain.explanation import Explanation, Reading, Stretch
    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.signal import Signal

#: Sub-formulas that are shown at most; of a larger formula those next to its top.
_MOST = 200

#: Readings of a cause that are drawn one by one; more would be indistinguishable, so their interval is drawn.
_READINGS = 1000

_PLACES = "φψχ"


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """Signals that are drawn together, and the numbers that predicates compare them with."""

    lines: tuple[Line, ...]
    thresholds: tuple[float, ...]
    #: Stretches of the implicant whose predicates read one of the signals.
    because: tuple[Range, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A sub-formula down to predicates: its robustness over time, and where it fails.

    ``label`` is its own operator, with φ, ψ and χ for the operands; ``children`` are numbers of nodes, and
    ``hidden``: whether there are operands too far down to be shown.
    """

    formula: Formula
    text: str
    label: str
    name: str | None
    line: Line
    fails: tuple[Range, ...]
    children: tuple[int, ...]
    hidden: bool
    because: tuple[Range, ...]

    def fails_at(self, position: float) -> bool:
        """Return whether the sub-formula does not hold at a position."""
        return any(start <= position < end for start, end in self.fails)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The contents of a plot or a report of one result; positions are those of ``x_axis``.

    ``nodes``: the formula first, then its sub-formulas, those next to the top first; equal ones are one.
    ``critical``: the node and the position of the critical point, if a predicate decides.
    """

    title: str
    explanation: Explanation
    x_axis: XAxis
    dense: bool
    panels: tuple[Panel, ...]
    nodes: tuple[Node, ...]
    at: float
    critical: tuple[int, float] | None
    #: The bounds of the robustness at the start after each sample, if requested.
    band: Band | None = None

    @property
    def verdict(self) -> str:
        """The verdict, the robustness, and the first violation."""
        explanation = self.explanation
        return (
            explanation.headline
            if explanation.first_violation is None
            else f"{explanation.headline}, {explanation.summary[1]}"
        )

    def window(self, start: Any = None, end: Any = None, zoom: str | None = None) -> tuple[float, float]:
        """Return the positions from one time to another; by default all, with ``zoom="violation"`` those around it.

        Raises :class:`UsageError` if there is nothing in between, or no violation.
        """
        low, high = self.x_axis.start, self.x_axis.end
        if zoom is not None:
            if zoom != "violation":
                raise UsageError(f"cannot zoom to '{zoom}'; the only choice is 'violation'")
            violation = self.explanation.first_violation
            if violation is None:
                raise UsageError(f"cannot zoom to the violation: the formula is {self.verdict}")
            low, high = self._around(self.x_axis.position(violation))
        return visible(self.x_axis, start, end, (low, high))

    def _around(self, violation: float) -> tuple[float, float]:
        """Return the positions around a violation: the causes that it touches, and something on either side."""
        causes = [each for node in self.nodes for each in node.because if each[0] <= violation <= each[1]]
        low = min([violation, *(start for start, _ in causes)])
        high = max([violation, *(end for _, end in causes)])
        whole = self.x_axis.end - self.x_axis.start
        samples = 20 * whole / max(len(self.nodes[0].line.positions) - 1, 1)
        margin = max(0.5 * (high - low), 0.02 * whole if self.dense else samples)
        return max(low - margin, self.x_axis.start), min(high + margin, self.x_axis.end)

    def shown_at(self, number: int) -> float:
        """Return the position at which a node's value is shown: of parts of a violated formula its first violation."""
        violation = self.explanation.first_violation
        return self.at if number == 0 or violation is None else self.x_axis.position(violation)

    def chosen(self, count: int) -> tuple[int, ...]:
        """Return the numbers of the ``count`` most important nodes, in the order of the formula.

        Of many requirements, violated ones are more important.
        """
        wanted = [0]
        named = [i for i, node in enumerate(self.nodes) if node.name]
        wanted += [i for i in self.nodes[0].children if i in named and self.nodes[i].fails_at(self.at)]
        wanted += named
        wanted += [] if self.critical is None else [self.critical[0]]
        wanted += [i for i, node in enumerate(self.nodes) if node.because]
        wanted += range(len(self.nodes))
        best = set(list(dict.fromkeys(wanted))[:count])
        return tuple(i for i in self.preorder() if i in best)

    def preorder(self) -> tuple[int, ...]:
        """Return the numbers of the nodes in the order of the formula, each once."""
        found: dict[int, None] = {}
        stack = [0]
        while stack:
            number = stack.pop()
            if number not in found:
                found[number] = None
                stack.extend(reversed(self.nodes[number].children))
        return tuple(found)


def scene(result: Result, at: Any = None, *, bounds: bool = False) -> Scene:
    """Return the content of the plot of a result, explained at an instant (by default the first).

    ``bounds``: also what was known after each sample; see :func:`~rtamt.plot.band.band`.
    """
    return _Painter(result, at).scene(band(result) if bounds else None)


class _Painter:
    """Collects the scene of one result."""

    def __init__(self, result: Result, at: Any) -> None:
        self._result = result
        self._spec = result.specification
        self._explanation = result.explain(at)
        self._x_axis = XAxis.of(result.trace)
        self._end = self._x_axis.end
        self._dense = result.trace.domain.continuous
        self._implicant = tuple(self._explanation.implicant)
        self._because: dict[Formula | None, list[Stretch]] = {}
        for stretch in self._implicant:
            self._because.setdefault(stretch.formula, []).append(stretch)
        #: The positions of times: intervals of the implicant share theirs with what they read.
        self._positions: dict[Any, float] = {}

    def scene(self, known: Band | None) -> Scene:
        formulas = sub_formulas(self._spec.formula)
        places = {formula: i for i, formula in enumerate(formulas)}
        point = self._explanation.critical
        critical = None
        if point.formula in places:
            critical = (places[point.formula], self._x_axis.position(point.time))
        return Scene(
            self._spec.name or "",
            self._explanation,
            self._x_axis,
            self._dense,
            self._panels(formulas),
            tuple(
                self._node(formula, places, signals)
                for formula, signals in zip(formulas, self._signals(formulas), strict=True)
            ),
            self._x_axis.position(self._explanation.time),
            critical,
            known,
        )

    def _signals(self, formulas: Sequence[Formula]) -> Iterator[tuple[Signal, Signal]]:
        """Yield the robustness and the truth of each formula, all from one program."""
        semantics, roles = self._result.semantics, self._spec.roles
        outputs = [outputs_under(f, semantics, roles) for f in formulas]
        every = tuple(output for both in outputs for output in both)
        signals = iter(Evaluators(self._spec.backend)(every, self._result.trace))
        return zip(signals, signals, strict=True)

    def _node(self, formula: Formula, places: dict[Formula, int], signals: tuple[Signal, Signal]) -> Node:
        spec = self._spec
        text = predicate_text(formula, spec.text)
        name = spec.document.names_of.get(formula)
        line, truth = (self._line(text, signal) for signal in signals)
        operands = _operands(formula)
        numbers = tuple(places[operand] for operand in operands if operand in places)
        return Node(
            formula,
            text,
            text if is_predicate(formula) else _label(formula),
            name,
            line,
            ranges(truth, ~(truth.values > 0), dense=self._dense, end=self._end),
            numbers,
            len(numbers) < len(operands),
            self._cause_intervals(self._because.get(formula, ())),
        )

    def _panels(self, formulas: Sequence[Formula]) -> tuple[Panel, ...]:
        trace = self._result.trace
        lines = {name: self._recorded_line(name) for name in trace.columns}
        found = []
        for group in groups(lines, filter(is_predicate, formulas), trace.units):
            members = set(group.names)
            stretches: list[Stretch | Reading] = []
            for stretch in self._implicant:
                if len(stretch.reads) <= _READINGS:
                    stretches += [each for each in stretch.reads if each.signal in members]
                elif members & set(variables(stretch.formula)):
                    stretches.append(stretch)
            drawn = tuple(lines[name] for name in group.names)
            found.append(Panel(drawn, group.thresholds, self._cause_intervals(stretches)))
        return tuple(found)

    def _recorded_line(self, name: str) -> Line:
        unit, names = self._result.trace.units.get(name, ""), value_names(self._spec.types.get(name))
        return Line(name, *self._x_axis.recorded(name), unit, names)

    def _line(self, name: str, signal: Signal) -> Line:
        return Line(name, self._x_axis.positions(signal.times), signal.values)

    def _cause_intervals(self, stretches: Sequence[Stretch | Reading]) -> tuple[Range, ...]:
        """Return intervals of the implicant, or of what it reads, as they are drawn, within the recording."""
        half = float(self._result.trace.domain.period or 0) / 2  # around a sample
        position, last = self._position, self._end
        found = dict.fromkeys(
            (position(s.start) - half, last if s.end is None else min(position(s.end), last) + half)
            for s in stretches
        )
        return tuple((start, end) for start, end in found if start <= last)

    def _position(self, time: Any) -> float:
        found = self._positions.get(time)
        if found is None:
            found = self._positions[time] = self._x_axis.position(time)
        return found


def sub_formulas(formula: Formula) -> tuple[Formula, ...]:
    """Return the formula and its sub-formulas down to predicates, breadth first, equal ones once."""
    found: dict[Formula, None] = {formula: None}
    queue = deque([formula])
    while queue and len(found) < _MOST:
        node = queue.popleft()
        for child in _operands(node):
            if child not in found and len(found) < _MOST:
                found[child] = None
                queue.append(child)
    return tuple(found)


def _operands(formula: Formula) -> tuple[Formula, ...]:
    """Return the formulas that a formula is made of; a chain such as ``a and b and c`` is made of three.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> [str(part) for part in _operands(parse_formula("(x >= 3) and (y >= 3) and once(z >= 3)"))]
    ['x >= 3', 'y >= 3', 'once(z >= 3)']
    """
    if is_predicate(formula) or not isinstance(formula, Apply):
        return ()
    op, rest, found = formula.op, formula, []
    if op.fixity is Fixity.LEFT and op.bounds is Bounds.NONE:
        while isinstance(rest.args[0], Apply) and rest.args[0].op is op:
            found.append(rest.args[1])
            rest = rest.args[0]
    return (*rest.args, *reversed(found))


def _label(formula: Formula) -> str:
    """Return a formula's operator, with letters for its operands.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> _label(parse_formula("(x >= 3) until[0:5] (y >= 3)"))
    'φ until[0:5] ψ'
    >>> _label(parse_formula("(x >= 3) or (x >= 4) or (y >= 3)"))
    'φ or ψ or …'
    """
    if not isinstance(formula, Apply) or len(formula.args) > len(_PLACES):
        return str(formula)
    places = tuple(Var(letter) for letter in _PLACES[: len(formula.args)])
    text = str(Apply(formula.op, places, formula.interval))
    more = len(_operands(formula)) > len(formula.args)
    return f"{text} {formula.op.spellings[0]} …" if more else text
