"""Pastification Π (the paper's Definition 4): bounded future to past, exact for all mixed formulas.

The theorem: ρ(φ, w, t) = ρ(Π(φ), w, t + H(φ)) for every t at which t + H(φ) lies in the trace.
Two rules make it hold for formulas that mix past and future:

- a sub-formula without future operators is delayed as a whole, ``once[d,d](φ)``;
- a past operator over an operand that was delayed by d must not read the operand before its first
  value, so the operand is guarded by ``once[d,d](true)`` (false before d, true from d on).

So is an operand of an operation that may have no value, such as a root: before d it is a number for which there is one.
"""

from __future__ import annotations

from fractions import Fraction
from math import inf

from rtamt.errors import BoundError, SpecificationError
from rtamt.language.formula import Apply, Const, Formula, Interval, Parameter, fold, postorder
from rtamt.language.operators import STL, Bounds, Sort, Tense
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.type_rules import type_of
from rtamt.language.records import Known
from rtamt.language.shares import ShareKind
from rtamt.lazy.dataclasses import replace
from rtamt.rewrite.check import has_future, unbounded_future
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.partial import harmless, value_at

#: The largest number of distinct sub-formulas of a result: a shared one may be needed at 2ⁿ delays.
MOST = 100_000


def pastify(
    formula: Formula, period: Fraction = Fraction(1), text: str | None = None, unit: str = "s"
) -> Formula:
    """Return Π(φ): only past operators, and the same value H(φ) later.

    ``period`` (seconds) is the step of ``next``. ``unit``: the unit of bounds without one, both in the text
    of φ and in the text of Π(φ). Raises :class:`BoundError` at an operator whose
    future is unbounded, and :class:`SpecificationError` where the result has more than :data:`MOST` nodes.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> str(pastify(parse_formula("always[0:10](x >= 3 -> eventually[0:5] y >= 3)")))
    'historically[0:10](once[5:5](x >= 3) -> once[0:5](y >= 3))'
    """
    node = unbounded_future(formula)
    if node is not None:
        raise BoundError(
            f"Cannot pastify an unbounded {node.op.name}. Give it an upper bound, such as {node.op.name}[0:10]",
            text,
            node.span,
        )
    written = _unit(formula) or ("" if unit == "s" else unit)
    formula = expand_future_shorthand(formula)
    return _Pastifier(formula, period, text, written).delayed(
        formula, horizon(formula, period) or Fraction(0)
    )


def expand_future_shorthand(formula: Formula) -> Formula:
    """Expand derived temporal operators (rise, unless, …) where the future is involved.

    They are pastified by their meaning. Expansions may contain further such operators, which are expanded, too.
    """

    def step(node: Formula, below: tuple[tuple[Formula, bool], ...]) -> tuple[Formula, bool]:
        if not isinstance(node, Apply):
            return node, False
        args = tuple(arg for arg, _ in below)
        future = node.op.tense is Tense.FUTURE or any(ahead for _, ahead in below)
        defined = node.op.definition is not None
        ruled = bool(node.op.guards) or node.op.pastified is not None
        derived = future and node.op.tense is not Tense.NONE and not ruled
        if node.op.expansion is not None and (not defined or derived):
            expanded = expand_future_shorthand(node.op.expansion(*args, node.interval))
            if future or has_future(expanded):
                return expanded, True
        return replace(node, args=args), future

    return fold(formula, step)[0]


class _Delayed(Known):
    """Operands that are known from a delay on."""

    def __init__(self, pastifier: _Pastifier, delay: Fraction) -> None:
        self._pastifier, self._delay = pastifier, delay

    @property
    def now(self) -> Formula:
        return self._from(self._delay)

    @property
    def begun(self) -> Formula:
        return self.now

    def before(self, interval: Interval | None) -> Formula:
        assert interval is not None
        return self._from(self._delay + interval.begin)

    def _from(self, delay: Fraction) -> Formula:
        return self._pastifier.shifted(STL["true"](), delay)


class _Pastifier:
    """One pastification: the properties of each node, and the results so far (shared nodes once)."""

    def __init__(self, formula: Formula, period: Fraction, text: str | None, unit: str) -> None:
        self.period = period
        self.text = text
        self.unit = unit
        self.has_future: dict[int, bool] = {}
        # Those that have the same value at every instant; None: a value that can be set.
        self.constant: dict[int, float | None] = {}
        for node in postorder(formula):
            if isinstance(node, Const):
                self.constant[id(node)] = None if isinstance(node, Parameter) else node.value
            elif (
                isinstance(node, Apply)
                and node.args
                and node.op.tense is Tense.NONE
                and all(id(arg) in self.constant for arg in node.args)
            ):
                self.constant[id(node)] = value_at(node.op, [self.constant[id(arg)] for arg in node.args])
            below = any(self.has_future[id(arg)] for arg in node.args) if isinstance(node, Apply) else False
            self.has_future[id(node)] = below or (isinstance(node, Apply) and node.op.tense is Tense.FUTURE)

    def delayed(self, formula: Formula, delay: Fraction) -> Formula:
        """Return P with ρ(formula, w, t) = ρ(P, w, t + delay); ``delay`` is at least the horizon."""
        results: dict[tuple[int, Fraction], Formula] = {}
        stack = [(formula, delay)]
        while stack:  # an explicit stack, because formulas may be deeper than Python's recursion limit
            node, d = stack[-1]
            wanted = [(arg, self._operand_delay(node, d)) for arg in self._open_operands(node)]
            missing = [(arg, e) for arg, e in wanted if (id(arg), e) not in results]
            if missing:
                stack.extend(missing)
                continue
            stack.pop()
            if len(results) >= MOST:
                raise SpecificationError(
                    f"the pastified formula would have more than {MOST} different sub-formulas, one for each "
                    f"delay of a shared one; monitor the formula as it is, which needs no pastification",
                    self.text,
                    formula.span,
                )
            if (id(node), d) not in results:
                results[id(node), d] = self._build(node, d, tuple(results[id(a), e] for a, e in wanted))
        return results[id(formula), delay]

    def _open_operands(self, node: Formula) -> tuple[Formula, ...]:
        return node.args if isinstance(node, Apply) and self.has_future[id(node)] else ()

    def _operand_delay(self, node: Formula, delay: Fraction) -> Fraction:
        assert isinstance(node, Apply)
        if node.op.tense is not Tense.FUTURE:
            return delay
        if node.interval is None:
            one = node.op.bounds is Bounds.DURATION
            return delay - self.period * (1 if one else node.op.reach or 0)
        assert node.interval.end is not None
        return delay - node.interval.end

    def _build(self, node: Formula, delay: Fraction, args: tuple[Formula, ...]) -> Formula:
        if not self.has_future[id(node)]:
            return self.shifted(node, delay)
        assert isinstance(node, Apply)
        args = tuple(map(self._as_number, node.op.operands, node.args, args))
        if node.op.tense is Tense.FUTURE:
            return _past_twin(node, args, self.text)
        if node.op.tense is Tense.PAST and node.op.pastified is not None:
            return self._by_rule(node, args, delay)
        if node.op.tense is Tense.PAST:
            if len(node.op.guards) != len(args):
                raise _no_rule(node, "guards", self.text)
            args = tuple(
                self._guard_operand(arg, _guard(node, how), delay, sort)
                for arg, how, sort in zip(args, node.op.guards, node.op.operands, strict=True)
            )
        elif delay:
            args = self._with_a_value(node, args, delay)
        return Apply(node.op, args, node.interval, node.span)

    def _with_a_value(self, node: Apply, args: tuple[Formula, ...], delay: Fraction) -> tuple[Formula, ...]:
        """Return operands with which an operation on numbers has a value before they mean anything, too."""
        known = [self.constant.get(id(arg)) for arg in node.args]
        typed = node.op.equates and any(type_of(arg) is not None for arg in node.args)  # codes are finite
        instead = {} if typed else harmless(node.op, known)
        meant = self.shifted(STL["true"](), delay)
        return tuple(
            _choose(meant, arg, Const(instead[k])) if k in instead else arg for k, arg in enumerate(args)
        )

    def shifted(self, formula: Formula, delay: Fraction) -> Formula:
        if delay == 0:
            return formula
        return Apply(STL["once"], (formula,), Interval(delay, delay, self.unit, self.unit), formula.span)

    def _as_number(self, sort: Sort, operand: Formula, delayed: Formula) -> Formula:
        """Return a delayed number as a number: before its first value, ``once`` would make it infinite."""
        if sort is not Sort.NUMBER or is_number(delayed) or not is_number(operand):
            return delayed
        if id(operand) in self.constant:
            return operand
        assert isinstance(delayed, Apply)
        return replace(delayed, op=STL["delay"])

    def _by_rule(self, node: Apply, args: tuple[Formula, ...], delay: Fraction) -> Formula:
        if delay == 0:
            return Apply(node.op, args, node.interval, node.span)
        assert node.op.pastified is not None
        interval = node.interval
        if interval is None and node.op.bounds is Bounds.DURATION:
            interval = Interval(self.period, self.period, implied=True)
        return node.op.pastified(args, interval, _Delayed(self, delay))

    def _guard_operand(self, operand: Formula, how: str | None, delay: Fraction, sort: Sort) -> Formula:
        if how is None or delay == 0:
            return operand
        meant = self.shifted(STL["true"](), delay)
        if sort is Sort.NUMBER:
            return Apply(STL["if"], (meant, operand, Const(_INSTEAD[how])), None, operand.span)
        pair = (meant, operand) if how == "implies" else (operand, meant)
        return Apply(STL[how], pair, None, operand.span)


def _choose(condition: Formula, operand: Formula, instead: Formula) -> Formula:
    """Return the operand of an operation on numbers where a condition is true, else another one."""
    if is_number(operand):
        return Apply(STL["if"], (condition, operand, instead), None, operand.span)
    # A formula is no operand of `if`.
    both = STL["and"](condition, operand), STL["and"](STL["not"](condition), instead)
    return Apply(STL["or"], both, None, operand.span)


#: A number that counts as none, as true and as false.
_INSTEAD = {"zero": 0.0, "implies": inf, "and": -inf}


def _unit(formula: Formula) -> str:
    """Return the unit in which the bounds of the formula are written, so that delays look the same."""
    intervals = (node.interval for node in postorder(formula) if isinstance(node, Apply))
    units = (
        unit for i in intervals if i is not None and not i.implied for unit in (i.end_unit, i.begin_unit)
    )
    return next(filter(None, units), "")


def _guard(node: Apply, how: str | None) -> str | None:
    """Return the guard of an operand; that of a share counts as true or false outside the trace."""
    if not node.op.share:
        return how
    assert node.interval is not None
    assert node.interval.share is not None
    return "implies" if node.interval.share.kind is ShareKind.PERCENT else "and"


def _past_twin(node: Apply, args: tuple[Formula, ...], text: str | None) -> Formula:
    if node.op.twin == "":
        return args[0]  # next: only its operand is delayed
    twin = STL.get(node.op.twin) if node.op.twin is not None else None
    if twin is None:
        raise _no_rule(node, "past twin", text)
    interval = node.interval
    assert interval is not None
    assert interval.end is not None
    if len(args) == 1:
        unit = interval.end_unit
        width = interval.end - interval.begin
        interval = Interval(Fraction(0), width, "", unit, interval.span, share=interval.share)
    return Apply(twin, args, interval, node.span)


def _no_rule(node: Apply, lacking: str, text: str | None) -> SpecificationError:
    return SpecificationError(
        f"Cannot pastify '{node.op.name}': its record names no {lacking}; monitor the formula as it is, "
        f"which needs no pastification",
        text,
        node.span,
    )
