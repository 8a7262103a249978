"""Formulas as sentences of FRETish: the reverse of ``formalize`` and ``lower``.

The formula of every combination of scope, condition and timing is built with placeholders; a requirement that equals
one of them, with its own formulas in their places, is that sentence.
"""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isinf
from typing import TYPE_CHECKING

from rtamt.interchange.dialect import InexpressibleError
from rtamt.interchange.fret.expressions import INFIX, KEYWORDS
from rtamt.interchange.fret.formalize import TIMINGS, formalize, inside
from rtamt.interchange.fret.lower import FUNCTIONS, is_function
from rtamt.interchange.fret.sentence import TIME_UNITS
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, fold, size
from rtamt.language.operators import STL, Sort
from rtamt.language.units.durations import decimal
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

_RESPONSE, _MODE, _CONDITION, _STOP = (Var(f"?{name}") for name in ("response", "mode", "condition", "stop"))
#: The duration of placeholders in samples, which no bound of a formula of one has by chance.
_SAMPLES = 1_000_003
#: How deep formulas may nest, in which operators in a row nest, too.
_MOST_DEEP = 300
_NAME = lazy_pattern(r"[A-Za-z][\w.%]*", re.ASCII)
#: What FRET's lexer reads as a word of its own, more than sentences here have.
_RESERVED = frozenset(
    "false first last next occurrence of previous probability same timepoint true what with".split()
).union(KEYWORDS, INFIX, *((unit, f"{unit}s") for unit in TIME_UNITS))
_SYMBOLS = {name: (strength, symbol) for symbol, (strength, name) in reversed(INFIX.items())}
_CALLS = {operator: function for function, operator in reversed(FUNCTIONS.items())}
_WORDS = {"in": "While", "notin": "Except while", "before": "Before", "after": "After"}


class _Shape(NamedTuple):
    """The formula of a combination of fields, with placeholders, and its words."""

    formula: Formula
    scope: str
    only: bool
    condition: str
    timing: str
    exact: bool


@dataclass(frozen=True, slots=True)
class Written:
    """A sentence; ``exact``: whether it is the formula also where the trace ends before a window does."""

    sentence: str
    exact: bool


def sentence_of(formula: Formula, component: str, step: Fraction) -> Written:
    """Return a requirement as a sentence of FRETish.

    Args:
        formula: what must hold at the first instant.
        component: the name of the component that the sentence is about.
        step: the sampling period in seconds.

    Raises:
        InexpressibleError: no sentence of FRETish has this meaning.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("always(rise(c >= 1) -> eventually[0:3](r >= 1) or always[3:3] false)")
    >>> sentence_of(formula, "pump", Fraction(1)).sentence
    'When c >= 1 the pump shall within 3 ticks satisfy r >= 1'
    """
    if fold(formula, _depth) > _MOST_DEEP:
        raise InexpressibleError(
            f"more than {_MOST_DEEP} operators are in a row or inside one another: split the requirement"
        )
    reason: InexpressibleError | None = None
    for shape in _shapes():
        found = _Match(step)
        if found.equal(shape.formula, formula):
            try:
                return Written(_words(shape, found, component, step), shape.exact)
            except InexpressibleError as error:
                reason = reason or error
    raise reason or InexpressibleError("no timing of FRETish has this meaning")


def _depth(_node: Formula, args: tuple[int, ...]) -> int:
    return 1 + max(args, default=0)


@lru_cache(maxsize=1)
def _shapes() -> tuple[_Shape, ...]:
    """Return every combination, those with the most particular formulas first."""
    return tuple(sorted(_combinations(), key=lambda shape: (bool(shape.scope), -size(shape.formula))))


def _combinations() -> Iterator[_Shape]:
    for scope in ("", *_WORDS):
        for only in (False, True) if scope and scope != "notin" else (False,):
            where = inside(scope, _MODE, only=only) if scope else None
            for condition in ("", "When", "Whenever"):
                for timing in TIMINGS:
                    formula = formalize(
                        timing,
                        _RESPONSE,
                        step=Fraction(1),
                        scope=where,
                        condition=_CONDITION if condition else None,
                        holding=condition == "Whenever",
                        only=only,
                        stop=_STOP,
                        duration=Fraction(_SAMPLES),
                    )
                    yield _Shape(formula, scope, only, condition, timing, True)
                    shorter = _without_end(formula)
                    if shorter != formula:
                        yield _Shape(shorter, scope, only, condition, timing, False)


def _without_end(formula: Formula) -> Formula:
    """Return a formula without the exceptions for the end of the trace."""
    beyond = STL["always"](STL["false"](), interval=Interval(Fraction(_SAMPLES), Fraction(_SAMPLES)))

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        if node.op is STL["or"] and args[1] == beyond:
            return args[0]
        return node.op(*args, interval=node.interval)

    return fold(formula, step)


class _Match:
    """The formulas for the placeholders of a shape; ``samples``: the duration of the timing."""

    def __init__(self, step: Fraction) -> None:
        self._step = step
        self.found: dict[str, Formula] = {}
        self.samples: Fraction | None = None

    def equal(self, shape: Formula, formula: Formula) -> bool:
        """Return whether a formula matches a shape, and keep the formulas of its placeholders."""
        pairs = [(shape, formula)]
        while pairs:
            a, b = pairs.pop()
            if isinstance(a, Var):
                if self.found.setdefault(a.name, b) != b:
                    return False
            elif not (isinstance(a, Apply) and isinstance(b, Apply)):
                if a != b:
                    return False
            elif a.op is not b.op or len(a.args) != len(b.args) or not self._same(a.interval, b.interval):
                return False
            else:
                pairs += zip(a.args, b.args, strict=True)
        return True

    def _same(self, a: Interval | None, b: Interval | None) -> bool:
        if a is None or b is None:
            return a is b
        if b.end is None or a.end is None or b.is_open or b.share is not None:
            return False
        return self._same_bound(a.begin, b.begin) and self._same_bound(a.end, b.end)

    def _same_bound(self, shape: Fraction, bound: Fraction) -> bool:
        samples = bound / self._step
        if shape < _SAMPLES:
            return samples == shape
        duration = samples - (shape - _SAMPLES)
        self.samples = duration if self.samples is None else self.samples
        return duration == self.samples >= 0 and duration.denominator == 1


def _words(shape: _Shape, found: _Match, component: str, step: Fraction) -> str:
    def text(placeholder: Var, strength: int = 0) -> str:
        return expression_of(found.found[placeholder.name], step, strength)

    parts: list[str] = []
    if shape.scope:
        word = f"Only {_WORDS[shape.scope].lower()}" if shape.only else _WORDS[shape.scope]
        parts.append(f"{word} {text(_MODE)},")
    if shape.condition:
        word = shape.condition.lower() if parts else shape.condition
        parts.append(f"{word} {text(_CONDITION)}")
    parts.append(f"the {component} shall" if parts else f"The {component} shall")
    if shape.timing == "next":
        parts.append("at the next timepoint")
    elif shape.timing in ("within", "for", "after"):
        assert found.samples is not None
        parts.append(f"{shape.timing} {found.samples} ticks")
    elif shape.timing in ("until", "before"):
        parts.append(f"{shape.timing} {text(_STOP)}")
    else:
        parts.append(shape.timing)
    return " ".join([*parts, "satisfy", text(_RESPONSE)])


# ---- expressions ---------------------------------------------------------------------------------


def expression_of(formula: Formula, step: Fraction, strength: int = 0) -> str:
    """Return a formula without a timing of its own as an expression of FRETish.

    Args:
        formula: a formula or a term.
        step: the sampling period in seconds.
        strength: how tightly the operator beside it binds; a looser expression gets parentheses.

    Raises:
        InexpressibleError: FRETish has no operator of that meaning.
    """
    if isinstance(formula, Const):
        return _quote_name(formula.name) if formula.name else _number(formula.value)
    if isinstance(formula, Var):
        if formula.bound:
            raise InexpressibleError(f"'{formula}' is a field of a group's members, which FRET does not have")
        return _quote_name(formula.name)
    assert isinstance(formula, Apply)
    name, args = formula.op.name, formula.args

    def below(operand: Formula, tightness: int = 0) -> str:
        return expression_of(operand, step, tightness)

    if name in ("true", "false"):
        return name
    if name == "not":
        return _bracket(f"!{below(args[0], 8)}", 4, strength)
    if name == "neg":
        text = below(args[0], 9)
        if text[0].isdigit() and not isinstance(args[0], Const):
            text = f"({text})"  # the sign would belong to the number
        return _bracket(f"-{text}", 8, strength)
    if formula.op is TRUTH:
        return expression_of(args[0], step, strength)
    name = name.removeprefix("holds_")
    if name in _SYMBOLS:
        _check_operands(formula)
        tightness, symbol = _SYMBOLS[name]
        text = f"{below(args[0], tightness)} {symbol} {below(args[1], tightness + 1)}"
        return _bracket(text, tightness, strength)
    if is_function(formula.op):
        return f"{_CALLS.get(name, name)}({', '.join(map(below, args))})"
    return _temporal(formula, step, strength)


def _check_operands(formula: Apply) -> None:
    """Raise if a number is used as a formula, or a Boolean as a number: FRETish separates them."""
    for operand in formula.args:
        boolean = isinstance(operand, Var) and operand.type is BOOLEAN
        number = isinstance(operand, Const | Var) or (
            isinstance(operand, Apply) and operand.op.result is Sort.NUMBER
        )
        if formula.op.operands[0] is Sort.NUMBER and boolean:
            raise InexpressibleError(f"'{operand}' is true or false and stands for a number, in '{formula}'")
        if formula.op.operands[0] is not Sort.NUMBER and number:
            raise InexpressibleError(
                f"'{operand}' is a number that stands for a formula: compare it, such as x > 0"
            )


def _temporal(formula: Apply, step: Fraction, strength: int) -> str:
    """Return what FRET's temporal functions express: the sample before, and windows from or to this instant."""
    name, args, interval = formula.op.name, formula.args, formula.interval

    def inner(operand: Formula = args[0]) -> str:
        return expression_of(operand, step)

    def negated() -> str:
        return f"!{expression_of(args[0], step, 8)}"

    if name in ("prev", "s_prev"):
        return f"preBool({'true' if name == 'prev' else 'false'}, {inner()})"
    if name == "rise":
        return _bracket(f"{expression_of(args[0], step, 3)} & preBool(true, {negated()})", 3, strength)
    if name == "fall":
        return _bracket(f"preBool(true, {inner()}) & {negated()}", 3, strength)
    one_sample = interval is None or (interval.begin == interval.end == step)
    if name in ("delay", "diff", "rate") and one_sample:
        before = f"preReal({inner(args[1]) if len(args) > 1 else inner()}, {inner()})"
        change = f"{expression_of(args[0], step, 6)} - {before}"
        if name == "rate":
            return _bracket(f"({change}) / {decimal(step)}", 7, strength)
        return before if name == "delay" else _bracket(change, 6, strength)
    if name in ("once", "eventually") and interval is not None and args[0] == STL["true"]():
        # The number of samples before, or after.
        samples = interval.begin / step
        if interval.begin == interval.end and samples.denominator == 1:
            return f"{'persisted' if name == 'once' else 'persists'}({samples}, true)"
    if name in ("once", "eventually", "historically", "always") and interval is not None:
        end = None if interval.end is None else interval.end / step
        if interval.begin == 0 and end is not None and end.denominator == 1 and not interval.is_open:
            past = name in ("once", "historically")
            some = "occurred" if past else "occurs"
            if name in ("once", "eventually"):
                return f"{some}({end}, {inner()})"
            return _bracket(f"!{some}({end}, {negated()})", 4, strength)
    raise InexpressibleError(
        f"FRETish has no '{formula.op.spellings[0]}' inside of an expression, as in '{formula}'"
    )


def _bracket(text: str, tightness: int, strength: int) -> str:
    return f"({text})" if tightness < strength else text


def _number(value: float) -> str:
    if isinf(value):
        raise InexpressibleError("FRETish has no infinite numbers")
    return f"{Decimal(repr(value)):f}".removesuffix(".0")


def _quote_name(name: str) -> str:
    reason = why_no_name(name)
    if reason:
        raise InexpressibleError(f"'{name}' cannot be a variable of FRETish{reason}")
    return name


def why_no_name(name: str) -> str:
    """Return why FRET does not read a name, to follow what it names; empty if it does."""
    if not _NAME.fullmatch(name):
        return ": use letters, digits and underscores"
    return ", where it is a keyword" if name.lower() in _RESERVED else ""
