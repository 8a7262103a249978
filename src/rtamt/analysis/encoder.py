"""Formulas as terms: what the engine computes on each trace of at most N samples, for all of these traces at once.

The operator table determines the encoding, as it does for the engine: the ``source`` of an operator that picks values,
its ``kernel``, or its ``expansion``. An operator with none that is linear is not covered, and is named by an error.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.analysis.arithmetic import ENCODED
from rtamt.analysis.sequences import Sequences
from rtamt.analysis.values import NotLinear, Number, Value, Values, Verdict
from rtamt.errors import SpecificationError
from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.language.operators import (
    Ahead,
    Fixity,
    Operator,
    Pointwise,
    Rank,
    Shift,
    Since,
    Sort,
    Source,
    Sum,
    Tense,
    Until,
    Window,
)
from rtamt.language.printing.printer import excerpt
from rtamt.language.shares import rank_of
from rtamt.language.value_types import Boolean, Enumeration
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.ground import ground
from rtamt.rewrite.semantics import boolean
from rtamt.rewrite.truth import replaced

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.analysis.solver import Real, Solver, Truth

#: How many instants a coarse trace changes at: from its start, from its middle, and before its end.
_START, _MIDDLE, _END = 8, 2, 4

#: A predicate by its distance from its threshold: +inf where that is at least the margin, -inf where it is at most
#: minus the margin. Not part of the language.
_MARGIN = Operator(
    "margin", ("margin",), Fixity.FUNCTION, 200, (Sort.FORMULA,), Sort.FORMULA, "A predicate with a margin.",
    "margin(x >= 3)", definition=lambda x: x,
)  # fmt: skip


class NotCoveredError(SpecificationError):
    """The analysis does not cover a part of a formula; the message names it and the reason."""


class Limits(NamedTuple):
    """The declared range of a variable, and that of its change per second."""

    range: tuple[float, float] | None = None
    rate: tuple[float, float] | None = None


class Encoder:
    """The values of formulas over the traces of 1 to ``samples`` samples, as terms of a solver.

    ``period``: of sampling. ``limits``: of variables. ``whole``: only the traces of ``samples`` samples. ``coarse``:
    only those whose variables change at a few instants, a smaller problem. ``inside``: whether the trace has each
    sample. ``columns``: the values of each variable that a formula reads.
    """

    def __init__(
        self,
        solver: Solver,
        samples: int,
        period: Fraction,
        limits: Mapping[str, Limits] = MappingProxyType({}),
        *,
        whole: bool = False,
        coarse: bool = False,
    ) -> None:
        self.solver = solver
        self.samples = samples
        self._changes = _changes(samples) if coarse else range(samples)
        self.period = period
        self._limits = limits
        self.values = Values(solver)
        self.inside: list[Truth] = [True, *(whole or solver.truth() for _ in range(samples - 1))]
        for earlier, later in pairwise(self.inside):
            solver.require(solver.some((earlier, solver.no(later))))
        self.sequences = Sequences(self.values, self.inside)
        self.columns: dict[str, list[Number]] = {}
        self.margin: Real = solver.real()
        self._known: dict[Formula, list[Value]] = {}
        self._defined: dict[Formula, tuple[Truth, ...]] = {}

    def holds(self, formula: Formula, text: str | None = None) -> list[Truth]:
        """Return whether a formula holds at each instant, as defined by ``satisfied``."""
        _require_all_samples(formula, text)
        return [self._yes(value) for value in self._sequence(boolean(formula), text)]

    def robust(self, formula: Formula, text: str | None = None) -> list[Verdict]:
        """Return at each instant whether the robustness is at least the margin, or at most minus the margin."""
        distances = replaced(spelled_out(formula), _MARGIN)
        return [self._verdict(value) for value in self._sequence(distances, text)]

    def defined(self, formula: Formula) -> Truth:
        """Return whether each part of a formula has a value at each instant; elsewhere the engine reports an error."""
        parts = postorder(spelled_out(ground(boolean(formula), self.period)))
        return self.solver.every(each for part in parts for each in self._defined.get(part, ()))

    def length(self, least: int, most: int) -> list[Truth]:
        """Return assumptions on the least and the greatest number of samples."""
        found = [] if least < 2 else [self.inside[least - 1]]
        return found if most >= self.samples else [*found, self.solver.no(self.inside[most])]

    # ---- nodes -----------------------------------------------------------------------------------

    def _sequence(self, formula: Formula, text: str | None) -> list[Value]:
        """Return the values of a formula that is spelled out; ``text``: the text for messages."""
        formula = spelled_out(ground(formula, self.period))
        for node in postorder(formula):
            if node not in self._known:
                below = node.args if isinstance(node, Apply) else ()
                try:
                    self._known[node] = self._encode(node, [self._known[each] for each in below])
                except NotLinear as reason:
                    raise NotCoveredError(
                        f"'{excerpt(node)}' is not covered by the analysis: {reason}", text, node.span
                    ) from None
                if self.values.defined:
                    self._defined[node] = tuple(self.values.defined)
                    self.values.defined.clear()
        return self._known[formula]

    def _encode(self, node: Formula, below: list[list[Value]]) -> list[Value]:
        if isinstance(node, Var):
            return [*self.column(node)]
        if isinstance(node, Const):
            return [self.values.constant(node.value)] * self.samples
        assert isinstance(node, Apply)
        operator = node.op
        if operator is _MARGIN:
            return [self._distant(value) for value in below[0]]
        if operator.source is not None:
            return self._pick(operator.source, node, below)
        if operator.kernel is not None:
            return self._compute(node, below)
        if operator.expansion is None:
            raise NotLinear(f"the operator '{operator.name}' has no expansion")
        return self._expand(operator.expansion(*node.args, node.interval), node.args, below)

    def _expand(
        self, expansion: Formula, operands: Sequence[Formula], below: list[list[Value]]
    ) -> list[Value]:
        """Return the values of an expansion, from those of the operands."""
        known = {id(operand): values for operand, values in zip(operands, below, strict=True)}

        def encoded(node: Formula) -> list[Value]:
            # Expansions are a few nodes deep, so plain recursion is safe here.
            if id(node) not in known:
                args = node.args if isinstance(node, Apply) else ()
                known[id(node)] = self._encode(node, [encoded(each) for each in args])
            return known[id(node)]

        return encoded(expansion)

    def _steps(self, node: Apply) -> tuple[int, int | None]:
        """Return the bounds of an operator in samples."""
        if node.interval is None:
            return 0, None
        end = node.interval.end
        return int(node.interval.begin / self.period), None if end is None else int(end / self.period)

    def _pick(self, source: Source, node: Apply, below: list[list[Value]]) -> list[Value]:
        choose = self.values.choose
        if source is Source.BRANCH:
            conditions, first, second = below
            return [choose(self._yes(c), a, b) for c, a, b in zip(conditions, first, second, strict=True)]
        if source is Source.DELAYED:
            xs, *rest = below
            d = self._steps(node)[0]
            before = rest[0] if rest else [xs[0]] * self.samples
            return [*before[:d], *xs[: max(0, self.samples - d)]][: self.samples]
        xs, conditions, *rest = below
        found: list[Value] = []
        ever: list[Truth] = []
        for x, c in zip(xs, map(self._yes, conditions), strict=True):
            ever.append(self.solver.some((*ever[-1:], c)))
            found.append(choose(c, x, found[-1]) if found else x)
        if rest:
            found = [choose(e, x, init) for e, x, init in zip(ever, found, rest[0], strict=True)]
        return found

    def _compute(self, node: Apply, below: list[list[Value]]) -> list[Value]:
        """Return the values of an operator with a kernel."""
        kernel, past, at = node.op.kernel, node.op.tense is Tense.PAST, self.sequences
        a, b = self._steps(node)
        match kernel:
            case Pointwise(opcode):
                encoding: Callable[..., Value] | None = ENCODED.get(opcode)
                if encoding is None:
                    raise NotLinear(f"'{node.op.spellings[0]}' is not linear")
                return self._pointwise(encoding, below)
            case Window(reduce):
                return (at.past if past else at.future)(below[0], reduce, a, b)
            case Shift(fill):
                return at.shift(below[0], fill, past=past)
            case Ahead():
                return at.ahead(below[0], a)
            case Rank():
                assert b is not None
                k, outside = rank_of(node.interval, self.period, continuous=False)
                return at.rank(below[0], a, b, k, outside, past=past)
            case Sum():
                return at.sums(below[0], a, b, self.period if node.op.timed else Fraction(1))
            case Since():
                return at.since(below[0], below[1], a, b)
            case Until() if past:
                assert b is not None
                return at.precedes(below[0], below[1], a, b)
            case Until():
                return at.until(below[0], below[1], a, b)
            case _:
                raise NotLinear(f"the operator '{node.op.name}' is a custom one")

    def _pointwise(self, encoding: Callable[..., Value], below: Sequence[Sequence[Value]]) -> list[Value]:
        """Return the value of an operator at each instant; equal operands share one computation."""
        found: list[Value] = []
        before: tuple[object, ...] = ()
        for here, *values in zip(self.inside, *below, strict=True):
            operands = (here, *values)
            same = before and all(a is b for a, b in zip(before, operands, strict=True))
            found.append(found[-1] if same else self._inside(here, encoding, values))
            before = operands
        return found

    def _inside(self, here: Truth, encoding: Callable[..., Value], operands: Sequence[Value]) -> Value:
        """Return a value that must be defined only inside the trace."""
        conditions = self.values.defined
        known = len(conditions)
        found = encoding(self.values, *operands)
        conditions[known:] = [self.solver.some((self.solver.no(here), each)) for each in conditions[known:]]
        return found

    # ---- values ----------------------------------------------------------------------------------

    def _yes(self, value: Value) -> Truth:
        """Return whether a value is positive."""
        if isinstance(value, Verdict):
            return value.yes
        return self.values.exceeds(value, self.values.constant(0.0))

    def _verdict(self, value: Value) -> Verdict:
        return value if isinstance(value, Verdict) else self._distant(value)

    def _distant(self, value: Value) -> Verdict:
        """Return whether a number is at least the margin, and whether it is at most minus the margin."""
        if isinstance(value, Verdict):
            return value
        margin = Number(self.margin)
        minus = self.values.minus(value)
        return Verdict(self.values.reaches(value, margin), self.values.reaches(minus, margin))

    def column(self, variable: Var) -> list[Number]:
        """Return the values of a variable at each instant."""
        name = variable.name
        if name not in self.columns:
            make: Callable[[], Number]
            match variable.type:
                case Boolean():
                    make = partial(self._one_of, (1, 0))
                case Enumeration():
                    make = partial(self._one_of, tuple(dict(variable.type.members).values()))
                case _:
                    make = self._any
            values = self.columns[name] = self._column(make)
            self._limit(values, self._limits.get(name, Limits()))
        return self.columns[name]

    def _column(self, make: Callable[[], Number]) -> list[Number]:
        """Return new values for all instants, which are one value from each change to the next."""
        found: list[Number] = []
        for t in range(self.samples):
            found.append(make() if t in self._changes else found[-1])
        return found

    def _limit(self, values: Sequence[Number], limits: Limits) -> None:
        """Keep a variable in its range and its rate."""
        reals = [value.real for value in values]
        if limits.range is not None:
            for t in self._changes:
                self.solver.require(self._between(reals[t], limits.range))
        if limits.rate is not None:
            rate = limits.rate
            for here, before, real in zip(self.inside[1:], reals, reals[1:], strict=False):
                difference = (
                    Fraction(0)
                    if real is before
                    else self.solver.total((real, self.solver.times(Fraction(-1), before)))
                )
                within = self._between(difference, rate, self.period)
                self.solver.require(self.solver.some((self.solver.no(here), within)))

    def _between(self, number: Real, ends: tuple[float, float], times: Fraction = Fraction(1)) -> Truth:
        low, high = ends
        at_most = self.solver.at_most
        return self.solver.every(
            (
                not isfinite(low) or at_most(Fraction(low) * times, number),
                not isfinite(high) or at_most(number, Fraction(high) * times),
            )
        )

    def _any(self) -> Number:
        return Number(self.solver.real())

    def _one_of(self, codes: Sequence[int]) -> Number:
        rest: Truth = True
        cases: list[tuple[Fraction, Truth]] = []
        *others, last = dict.fromkeys(codes)
        for code in others:
            chosen = self.solver.truth()
            cases.append((Fraction(code), self.solver.every((rest, chosen))))
            rest = self.solver.every((rest, self.solver.no(chosen)))
        return self.values.of_cases([*cases, (Fraction(last), rest)])


def _changes(samples: int) -> frozenset[int]:
    """Return the instants at which the variables of a coarse trace change: at its start, its middle and its end."""
    middle = samples // 2
    near = (range(_START), range(middle, middle + _MIDDLE), range(samples - _END, samples))
    return frozenset(t for each in near for t in each if 0 <= t < samples)


def _require_all_samples(formula: Formula, text: str | None) -> None:
    """Raise :class:`NotCoveredError` if a formula tests for missing samples; traces here have none."""
    for node in postorder(formula):
        if isinstance(node, Apply) and node.op.presence:
            raise NotCoveredError(
                f"'{excerpt(node)}' is not covered by the analysis: it depends on missing samples",
                text,
                node.span,
            )
