"""The operator table: every operator of the language, once.

One frozen record (``records.py``) per operator. Lexer, parser, printer, checks, horizon, desugaring,
pastification, compiler, command-line help, the generated reference and the test generators all derive from
this table; there is no second list. ``STL.extend(...)`` returns a new language.

The meaning of an operator is its ``definition``, a pure function on arrays (``definitions.py``). In
dense time a pointwise operator has the same meaning, value by value; a temporal operator has a function
``dense`` that gives its value at one instant (``dense_definitions.py``), or the meaning of its ``expansion``.
The implementation is either an ``expansion`` into simpler operators or a ``kernel``: one of five
shapes that the compiler supports, or a user-supplied class (``Blocks``, ``Compiled``). Names of opcodes are
those of the core.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import inf, nan
from typing import TYPE_CHECKING, Any

from rtamt.language import definitions as d
from rtamt.language import dense_definitions as dense
from rtamt.language import enclosures as e
from rtamt.language import function_enclosures as fe
from rtamt.language import functions as f
from rtamt.language.formula import Const, Formula, Interval
from rtamt.language.records import (
    Ahead,
    Blocks,
    Bounds,
    Compiled,
    Fixity,
    Kernel,
    Language,
    Operator,
    Pointwise,
    Rank,
    Shift,
    Since,
    Sort,
    Sum,
    Tense,
    Until,
    Window,
)

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = [
    "STL",
    "TRUTH",
    "Ahead",
    "Blocks",
    "Bounds",
    "Compiled",
    "Fixity",
    "Kernel",
    "Language",
    "Operator",
    "Pointwise",
    "Rank",
    "Shift",
    "Since",
    "Sort",
    "Sum",
    "Tense",
    "Until",
    "Window",
    "builtin",
    "holds",
    "is_truth",
]


def builtin(name: str) -> Operator | None:
    """Return the built-in operator with this name, in the table or not; built-in operators unpickle to it."""
    return STL.get(name) or _UNWRITTEN.get(name)


# ---- expansions: (operands..., interval) -> simpler formula -------------------------------------

N, F, C = Sort.NUMBER, Sort.FORMULA, Sort.CONDITION


def _ne(a: Formula, b: Formula, _i: Interval | None) -> Formula:
    return STL["not"](STL["eq"](a, b))


def _iff(a: Formula, b: Formula, _i: Interval | None) -> Formula:
    return STL["and"](STL["implies"](a, b), STL["implies"](b, a))


def _xor(a: Formula, b: Formula, _i: Interval | None) -> Formula:
    return STL["not"](_iff(a, b, None))


def _unless(a: Formula, b: Formula, i: Interval | None) -> Formula:
    whole = None if i is None else Interval(Fraction(0), i.end, "", i.end_unit, i.span, end_open=i.end_open)
    return STL["or"](STL["always"](a, interval=whole), STL["until"](a, b, interval=i))


def _before(a: Formula, tick: Interval | None) -> Formula:
    """Return the formula one sample, in dense time one tick, ago; it holds where there is none."""
    if tick is None:
        return STL["prev"](a)
    return STL["historically"](a, interval=replace(tick, implied=False))


def _rise(a: Formula, tick: Interval | None) -> Formula:
    return STL["and"](_before(STL["not"](a), tick), a)


def _fall(a: Formula, tick: Interval | None) -> Formula:
    return STL["and"](_before(a, tick), STL["not"](a))


def _function(name: str, arity: int, doc: str, example: str, **more: Any) -> Operator:
    more.setdefault("latex", rf"\mathrm{{{{{name}}}}}({', '.join(f'{{{k}}}' for k in range(arity))})")
    more.setdefault("operands", (N,) * arity)
    more.setdefault("result", N)
    return Operator(name, (name,), Fixity.FUNCTION, 200, doc=doc, example=example, **more)


def _infix(name: str, spellings: str, power: int, doc: str, example: str, **more: Any) -> Operator:
    more.setdefault("operands", (F, F))
    more.setdefault("result", F)
    return Operator(
        name,
        tuple(spellings.split()),
        more.pop("fixity", Fixity.LEFT),
        power,
        doc=doc,
        example=example,
        **more,
    )


def _prefix(name: str, spellings: str, power: int, doc: str, example: str, **more: Any) -> Operator:
    more.setdefault("operands", (F,))
    more.setdefault("result", F)
    return Operator(name, tuple(spellings.split()), Fixity.PREFIX, power, doc=doc, example=example, **more)


def _truth(code: str, spelling: str, symbol: str, definition: Any, **more: Any) -> Operator:
    if not more:
        slopes = e.slopes(0, 0) if code == "eq" else e.slopes(1, -1)
        more = {
            "kernel": Pointwise(f"holds_{code}"),
            "extension": getattr(e, f"holds_{code}"),
            "slopes": slopes,
        }
    doc, example = f"+inf where a {spelling} b, else -inf.", f"x {spelling} 3"
    latex = f"{{0}} {symbol} {{1}}"
    return _infix(
        f"holds_{code}",
        spelling,
        90,
        doc,
        example,
        operands=(N, N),
        definition=definition,
        latex=latex,
        **more,
    )


# Predicates by truth: +inf or -inf. They are not part of the language, though they are printed like the
# predicates; semantics that need a verdict instead of a distance (rewrite/semantics.py) insert them.
_GT, _GE = _truth("gt", ">", ">", d.holds_gt), _truth("ge", ">=", r"\geq", d.holds_ge)
_EQ = _truth("eq", "==", "=", d.holds_eq)
_LE = _truth("le", "<=", r"\leq", d.holds_le, expansion=lambda a, b, _i: STL["not"](_GT(a, b)))
_LT = _truth("lt", "<", "<", d.holds_lt, expansion=lambda a, b, _i: STL["not"](_GE(a, b)))
_NE = _truth("ne", "!=", r"\neq", d.holds_ne, expansion=lambda a, b, _i: STL["not"](_EQ(a, b)))

#: A Boolean (1 or 0) read as a formula: +inf where it is true, else -inf. Not written: it prints as its operand.
TRUTH = Operator(
    "truth", ("true",), Fixity.FUNCTION, 200, (N,), F, "+inf where a Boolean is true, else -inf.", "p", latex="{0}",
    definition=d.true_where, expansion=lambda a, _i: holds(a),
)  # fmt: skip
#: Operators that are +inf or -inf, outside the table.
_TRUTHS = (_GT, _GE, _EQ, _LE, _LT, _NE, TRUTH)


def is_truth(op: Operator) -> bool:
    """Return whether an operator by itself is +inf or -inf."""
    return op.presence or any(op is each for each in _TRUTHS)


def holds(number: Formula) -> Formula:
    """Return the formula that is +inf where ``number`` is positive, else -inf."""
    return _GT(number, Const(0.0))


def reaches(number: Formula, least: Formula) -> Formula:
    """Return the formula that is +inf where ``number`` is at least ``least``, else -inf."""
    return _GE(number, least)


# The first operand where it is at least the second, else undefined; not part of the language either.
_AT_LEAST = _function(
    "at_least", 2, "The first operand, which must be at least the second.", "at_least(x, 3) > 5",
    definition=f.at_least, kernel=Pointwise("at_least", partial=True), extension=fe.at_least,
    slopes=e.slopes(1, 0),
)  # fmt: skip

_UNWRITTEN = {op.name: op for op in (*_TRUTHS, _AT_LEAST)}


def choice(truth: Formula, a: Formula, b: Formula) -> Formula:
    """Return the number that is ``a`` where ``truth`` is +inf and ``b`` where it is -inf.

    Where bounds leave the truth open, those of the result are the hull of both numbers: hence the third part.
    """
    both = STL["min"](a, b)
    return STL["max"](STL["max"](STL["min"](truth, a), STL["min"](STL["neg"](truth), b)), both)


# ---- numbers at other instants ------------------------------------------------------------------

# The operand one step before, a sample or a tick; +inf at the start. Not part of the language.
_BEFORE = _prefix(
    "before", "before", 70, "One step ago.", "before(x >= 3)", tense=Tense.PAST, reach=1, one_tick=True,
    definition=d.prev, dense=dense.historically, kernel=Shift(inf),
)  # fmt: skip


def _held(x: Formula, truth: Formula, *rest: Any) -> Formula:
    *init, _interval = rest
    # x from the first step on; where bounds leave the truth open, the hull of both numbers.
    taken = STL["or"](truth, _BEFORE(Const(-inf)))
    last = STL["since"](STL["or"](STL["neg"](taken), x), STL["and"](taken, x))
    return choice(STL["once"](truth), last, init[0]) if init else last


def _delay(x: Formula, *rest: Any) -> Formula:
    *init, interval = rest
    before = STL["s_prev"] if interval is None else partial(STL["once"], interval=interval)
    instead = init[0] if init else _held(x, Const(-inf), None)
    return STL["or"](before(x), STL["and"](STL["neg"](before(Const(inf))), instead))


def _diff(x: Formula, interval: Interval | None) -> Formula:
    return STL["sub"](x, STL["delay"](x, interval=interval))


def _rate(x: Formula, interval: Interval | None) -> Formula:
    # Without a duration it is expanded only to see what it reads.
    seconds = float(interval.begin) if interval is not None else nan
    return STL["div"](_diff(x, interval), Const(seconds))


def _past_held(
    args: tuple[Formula, ...], _i: Interval | None, known: Callable[[Fraction], Formula]
) -> Formula:
    x, condition, *init = args
    given = known(Fraction(0))
    instead = init[0] if init else _since_when(x, given)
    return STL["held"](x, STL["and"](condition, given), instead)


def _past_delay(
    args: tuple[Formula, ...], i: Interval | None, known: Callable[[Fraction], Formula]
) -> Formula:
    x, *init = args
    assert i is not None
    instead = init[0] if init else _since_when(x, known(Fraction(0)))
    return STL["if"](known(i.begin), STL["delay"](x, interval=i), instead)


def _since_when(x: Formula, given: Formula) -> Formula:
    """Return x at the first instant at which ``given`` is true, from then on."""
    return STL["held"](x, STL["rise"](given))


def _clip(x: Formula, lo: Formula, hi: Formula, _i: Interval | None) -> Formula:
    return STL["min"](STL["max"](x, lo), _AT_LEAST(hi, lo))


def _wrap(x: Formula, lo: Formula, hi: Formula, _i: Interval | None) -> Formula:
    inside = STL["and"](_GE(x, lo), _GT(hi, x))
    # What is inside stays as it is; its difference from lo, which may overflow, is not computed.
    zero = Const(0.0)
    outside = STL["sub"](choice(inside, zero, x), choice(inside, zero, lo))
    turned = STL["add"](lo, STL["mod"](outside, _AT_LEAST(STL["sub"](hi, lo), zero)))
    return choice(inside, x, choice(_GE(turned, hi), lo, turned))


def _first(x: Formula) -> Formula:
    """Return the number that is the first value of ``x`` for ever."""
    return STL["sum"](STL["if"](STL["prev"](STL["false"]()), x, Const(0.0)))


def _mean(x: Formula, *rest: Any) -> Formula:
    *init, i = rest
    total, count = (STL["sum"](each, interval=i) for each in (x, Const(1.0)))
    begin, unit = (Fraction(0), "") if i is None else (i.begin, i.begin_unit)
    if begin == 0 and not init:
        return STL["div"](total, count)
    begun = STL["once"](STL["true"](), interval=Interval(begin, begin, unit, unit))
    mean = STL["div"](total, STL["max"](count, Const(1.0)))
    return STL["if"](begun, mean, *(init or (_first(x),)))


def _duration(condition: Formula, i: Interval | None) -> Formula:
    return STL["integral"](STL["if"](condition, Const(1.0), Const(0.0)), interval=i)


def _count(condition: Formula, i: Interval | None) -> Formula:
    return STL["sum"](STL["if"](STL["rise"](condition), Const(1.0), Const(0.0)), interval=i)


_SAMPLES = "adds samples, which dense time does not have; use minimum or maximum"
_COUNT = "counts samples at which a formula begins to hold; use rise or atleast"
_LINE = "of a step signal is a line, not a step, and dense time has steps only; use atleast with a duration"


def _math(
    name: str, doc: str, example: str, *slopes: int | None, definition: Any = None, **more: Any
) -> Operator:
    """Return a mathematical function; its definition, extension and opcode have its name."""
    definition = definition or getattr(f, name)
    more["extension"] = getattr(fe, name, None) or fe.rising(definition)
    more["kernel"] = Pointwise(name, more.pop("partial", False))
    more["strict"] = True
    return _function(name, len(slopes), doc, example, definition=definition, slopes=e.slopes(*slopes), **more)


STL: Language = Language.of((
    # ---- atoms -------------------------------------------------------------------------------
    Operator("true", ("true",), Fixity.ATOM, 200, (), F, "Always holds: +inf.", "true", r"\top",
             d.true, expansion=lambda _i: Const(inf)),
    Operator("false", ("false",), Fixity.ATOM, 200, (), F, "Never holds: -inf.", "false", r"\bot",
             d.false, expansion=lambda _i: Const(-inf)),
    # ---- numbers -----------------------------------------------------------------------------
    _function("abs", 1, "Absolute value.", "abs(x) <= 2", latex=r"\left|{0}\right|",
              definition=d.abs_, kernel=Pointwise("abs"), extension=e.abs_, slopes=e.slopes(0)),
    _function("sqrt", 1, "Square root.", "sqrt(x) <= 2", latex=r"\sqrt{{{0}}}",
              definition=d.sqrt, kernel=Pointwise("sqrt", partial=True), extension=e.sqrt, slopes=e.slopes(1)),
    _function("exp", 1, "The exponential function.", "exp(x) <= 2",
              definition=d.exp, kernel=Pointwise("exp"), extension=e.exp, slopes=e.slopes(1)),
    _function("pow", 2, "The first operand to the power of the second.", "pow(x, 2) <= 4",
              latex=r"{{{0}}}^{{{1}}}", definition=d.pow_, kernel=Pointwise("pow", partial=True),
              extension=e.pow_, slopes=e.slopes(None, None)),
    _function("log", 2, "The logarithm of the first operand to the base of the second.", "log(x, 10) >= 1",
              latex=r"\log_{{{1}}}({0})", definition=d.log, kernel=Pointwise("log", partial=True),
              extension=e.log, slopes=e.slopes(None, None)),
    _function("ln", 1, "The natural logarithm.", "ln(x) >= 0", latex=r"\ln({0})",
              definition=d.ln, kernel=Pointwise("ln", partial=True), extension=e.ln, slopes=e.slopes(1)),
    _function("min", 2, "The smallest operand.", "min(x, y) >= 0", latex=r"\min({0}, {1})",
              definition=d.and_, kernel=Pointwise("min"), extension=e.and_, slopes=e.slopes(1, 1), folds=True),
    _function("max", 2, "The largest operand.", "max(x, y) >= 0", latex=r"\max({0}, {1})",
              definition=d.or_, kernel=Pointwise("max"), extension=e.or_, slopes=e.slopes(1, 1), folds=True),
    _math("sin", "Sine of an angle in radians.", "sin(x) <= 1", 0, partial=True, latex=r"\sin({0})"),
    _math("cos", "Cosine of an angle in radians.", "cos(x) <= 1", 0, partial=True, latex=r"\cos({0})"),
    _math("tan", "Tangent of an angle in radians.", "tan(x) <= 1", 0, partial=True, latex=r"\tan({0})"),
    _math("asin", "Arc sine in radians.", "asin(x / 10) <= 1", 1, partial=True, latex=r"\arcsin({0})"),
    _math("acos", "Arc cosine in radians.", "acos(x / 10) <= 1", -1, partial=True, latex=r"\arccos({0})"),
    _math("atan", "Arc tangent in radians.", "atan(x) <= 1", 1, latex=r"\arctan({0})"),
    _math("atan2", "Angle of the point (second, first operand) in radians.", "atan2(y, x) <= 1", 0, 0),
    _math("hypot", "Length of a vector with two components.", "hypot(x, y) <= 5", 0, 0,
          latex=r"\sqrt{{{0}^2 + {1}^2}}"),
    _math("sinh", "Hyperbolic sine.", "sinh(x) <= 1", 1, latex=r"\sinh({0})"),
    _math("cosh", "Hyperbolic cosine.", "cosh(x) <= 2", 0, latex=r"\cosh({0})"),
    _math("tanh", "Hyperbolic tangent.", "tanh(x) <= 1", 1, latex=r"\tanh({0})"),
    _math("degrees", "Radians as degrees.", "degrees(x) <= 90", 1),
    _math("radians", "Degrees as radians.", "sin(radians(x)) <= 1", 1),
    _math("floor", "The greatest whole number that is not above the operand.", "floor(x) == 3", 1,
          latex=r"\lfloor {0} \rfloor"),
    _math("ceil", "The least whole number that is not below the operand.", "ceil(x) == 3", 1,
          latex=r"\lceil {0} \rceil"),
    _math("round", "The nearest whole number; halves away from zero.", "round(x) == 3", 1, definition=f.round_),
    _math("sign", "-1, 0 or 1: the sign of the operand.", "sign(x) == 1", 1),
    _math("mod", "The remainder of a division, with the sign of the divisor.", "mod(x, 360) <= 180", 0, None,
          partial=True),
    _function("clip", 3, "The number of [second, third operand] next to the first; an error where they are reversed.",
              "clip(x, -1, 1) >= 0", definition=f.clip, expansion=_clip, strict=True),
    _function("wrap", 3, "The first operand moved into [second, third) by whole multiples of their difference.",
              "wrap(x, -180, 180) <= 90", definition=f.wrap, expansion=_wrap, strict=True),
    Operator("if", ("if",), Fixity.CONDITIONAL, 100, (C, N, N), N,
             "The number after 'then' where the condition holds, else the number after 'else'.",
             "(if x >= 3 then x else y) <= 5", r"\mathbf{{if}}\ {0}\ \mathbf{{then}}\ {1}\ \mathbf{{else}}\ {2}",
             d.if_, expansion=lambda condition, a, b, _i: choice(condition, a, b), strict=True, keeps=(1, 2)),
    _prefix("neg", "-", 120, "Minus.", "-x >= 2", operands=(N,), result=N, latex="-{0}",
            definition=d.neg, kernel=Pointwise("neg"), extension=e.neg, slopes=e.slopes(-1)),
    _infix("mul", "*", 110, "Product.", "2 * x <= 3", operands=(N, N), result=N, latex=r"{0} \cdot {1}",
           definition=d.mul, kernel=Pointwise("mul", partial=True), extension=e.mul, slopes=e.of_product),
    _infix("div", "/", 110, "Quotient.", "x / 2 <= 3", operands=(N, N), result=N, latex=r"{0} / {1}",
           definition=d.div, kernel=Pointwise("div", partial=True), extension=e.div, slopes=e.of_quotient),
    _infix("add", "+", 100, "Sum.", "x + y <= 3", operands=(N, N), result=N, latex="{0} + {1}",
           definition=d.add, kernel=Pointwise("add", partial=True), extension=e.add, slopes=e.slopes(1, 1)),
    _infix("sub", "-", 100, "Difference.", "x - y <= 3", operands=(N, N), result=N, latex="{0} - {1}",
           definition=d.sub, kernel=Pointwise("sub", partial=True), extension=e.sub, slopes=e.slopes(1, -1)),
    # ---- predicates --------------------------------------------------------------------------
    _infix("ge", ">=", 90, "At least: a - b.", "x >= 3", operands=(N, N), latex=r"{0} \geq {1}", dual="lt",
           definition=d.ge, expansion=lambda a, b, _i: STL["sub"](a, b), truth=lambda a, b, _i: _GE(a, b)),
    _infix("gt", ">", 90, "More than: a - b.", "x > 3", operands=(N, N), latex="{0} > {1}", dual="le",
           definition=d.ge, expansion=lambda a, b, _i: STL["sub"](a, b), truth=lambda a, b, _i: _GT(a, b)),
    _infix("le", "<=", 90, "At most: b - a.", "x <= 3", operands=(N, N), latex=r"{0} \leq {1}", dual="gt",
           definition=d.le, expansion=lambda a, b, _i: STL["sub"](b, a), truth=lambda a, b, _i: _LE(a, b)),
    _infix("lt", "<", 90, "Less than: b - a.", "x < 3", operands=(N, N), latex="{0} < {1}", dual="ge",
           definition=d.le, expansion=lambda a, b, _i: STL["sub"](b, a), truth=lambda a, b, _i: _LT(a, b)),
    _infix("eq", "==", 90, "Equal: -|a - b|, at best 0.", "x == 3", operands=(N, N), latex="{0} = {1}", dual="ne",
           equates=True, definition=d.eq, expansion=lambda a, b, _i: STL["neg"](STL["abs"](STL["sub"](a, b))),
           truth=lambda a, b, _i: _EQ(a, b)),
    _infix("ne", "!= !==", 90, "Different: |a - b|.", "x != 3", operands=(N, N), latex=r"{0} \neq {1}", dual="eq",
           equates=True, definition=d.ne, expansion=lambda a, b, _i: STL["abs"](STL["sub"](a, b)),
           truth=lambda a, b, _i: _NE(a, b)),
    _function("valid", 1, "The variable has a sample here; everywhere if none is missing.", "valid(x)", result=F,
              definition=d.valid, expansion=lambda a, _i: _GE(a, a), presence=True),
    # ---- Boolean -----------------------------------------------------------------------------
    _prefix("not", "not !", 80, "Negation: minus.", "not (x >= 3)", latex=r"\neg {0}",
            definition=d.neg, expansion=lambda a, _i: STL["neg"](a)),
    _infix("and", "and & &&", 40, "Both: the smaller value.", "x >= 3 and y >= 3", latex=r"{0} \wedge {1}",
           dual="or", definition=d.and_, kernel=Pointwise("min"), extension=e.and_, slopes=e.slopes(1, 1)),
    _infix("or", "or | ||", 30, "At least one: the larger value.", "x >= 3 or y >= 3", latex=r"{0} \vee {1}",
           dual="and", definition=d.or_, kernel=Pointwise("max"), extension=e.or_, slopes=e.slopes(1, 1)),
    _infix("implies", "-> implies", 20, "If the first then the second: max(-a, b).", "x >= 3 -> y >= 3",
           latex=r"{0} \to {1}", fixity=Fixity.RIGHT,
           definition=d.implies, expansion=lambda a, b, _i: STL["or"](STL["not"](a), b)),
    _infix("iff", "<-> iff", 15, "Both or neither: (a -> b) and (b -> a).", "x >= 3 <-> y >= 3",
           latex=r"{0} \leftrightarrow {1}", dual="xor", definition=d.iff, expansion=_iff),
    _infix("xor", "xor", 10, "One but not both: not (a <-> b).", "x >= 3 xor y >= 3",
           latex=r"{0} \oplus {1}", dual="iff", definition=d.xor, expansion=_xor),
    # ---- windows -----------------------------------------------------------------------------
    _prefix("always", "always G", 75, "At every instant of the window ahead: the smallest value.",
            "always[0:5](x >= 3)", latex=r"\mathbf{{G}}_{I} {0}", tense=Tense.FUTURE, bounds=Bounds.OPTIONAL,
            definition=d.always, dense=dense.always, kernel=Window("min"), dual="eventually",
            twin="historically"),
    _prefix("eventually", "eventually F", 75, "At some instant of the window ahead: the largest value.",
            "eventually[0:5](x >= 3)", latex=r"\mathbf{{F}}_{I} {0}", tense=Tense.FUTURE, bounds=Bounds.OPTIONAL,
            definition=d.eventually, dense=dense.eventually, kernel=Window("max"), dual="always",
            twin="once"),
    _prefix("historically", "historically H", 75, "At every instant of the window behind: the smallest value.",
            "historically[0:5](x >= 3)", latex=r"\mathbf{{H}}_{I} {0}", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
            definition=d.historically, dense=dense.historically, kernel=Window("min"), dual="once",
            guards=("implies",)),
    _prefix("once", "once O", 75, "At some instant of the window behind: the largest value.",
            "once[0:5](x >= 3)", latex=r"\mathbf{{O}}_{I} {0}", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
            definition=d.once, dense=dense.once, kernel=Window("max"), dual="historically", guards=("and",)),
    # ---- shares of a window ------------------------------------------------------------------
    _function("atleast", 1, "In at least this share of the window ahead: the k-th largest value.",
              "atleast[0:5](80%, x >= 3)", operands=(F,), result=F,
              latex=r"\mathrm{{atleast}}_{I}({S}, {0})", tense=Tense.FUTURE, bounds=Bounds.REQUIRED, share=True,
              definition=d.atleast, dense=dense.atleast, kernel=Rank(), twin="wasatleast"),
    _function("wasatleast", 1, "In at least this share of the window behind: the k-th largest value.",
              "wasatleast[0:5](3s, x >= 3)", operands=(F,), result=F,
              latex=r"\mathrm{{wasatleast}}_{I}({S}, {0})", tense=Tense.PAST, bounds=Bounds.REQUIRED, share=True,
              definition=d.wasatleast, dense=dense.wasatleast, kernel=Rank(), guards=("implies",)),
    # ---- numbers over time -------------------------------------------------------------------
    _function("minimum", 1, "The least number of the window behind.", "minimum[0:5](x) >= 3",
              latex=r"\mathrm{{minimum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
              definition=d.historically, dense=dense.historically, kernel=Window("min"),
              guards=("implies",), strict=True),
    _function("maximum", 1, "The greatest number of the window behind.", "maximum[0:5](x) - x <= 3",
              latex=r"\mathrm{{maximum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
              definition=d.once, dense=dense.once, kernel=Window("max"),
              guards=("and",), strict=True),
    _function("sum", 1, "The sum of the samples in the window behind; 0 where there is none.", "sum[0:5](x) <= 3",
              latex=r"\mathrm{{sum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL, discrete_only=True,
              why_discrete=_SAMPLES, instead="count", definition=d.sum_, kernel=Sum(), guards=("zero",), strict=True),
    _function("mean", 2, "The mean of the samples in the window behind; the second operand where there is none, by default "
              "the first operand at the first sample.", "mean[0:5](x) <= 3", latex="", optional=1, tense=Tense.PAST,
              bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, instead="duration", definition=d.mean,
              expansion=_mean, strict=True),
    _function("integral", 1, "The sum over the window behind times the sampling period in seconds.",
              "integral[0:5](x) <= 3", latex=r"\mathrm{{integral}}_{I}({0})", tense=Tense.PAST,
              bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, instead="duration", definition=d.integral, kernel=Sum(), timed=True,
              guards=("zero",), strict=True),
    _function("duration", 1, "For how many seconds of the window behind a formula holds: samples times the period.",
              "duration[0:60](x >= 3) <= 10", operands=(C,), latex=r"\mathrm{{duration}}_{I}({0})", tense=Tense.PAST,
              bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, timed=True, definition=d.duration,
              expansion=_duration, guards=("and",)),
    _function("count", 1, "How often a formula begins to hold in the window behind.", "count[0:60](x >= 3) <= 10",
              operands=(C,), latex=r"\mathrm{{count}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
              before=1, discrete_only=True, why_discrete=_COUNT, definition=d.count, expansion=_count, guards=("and",)),
    _function("held", 3, "The first operand when the second was last true; the third, or its first value, where it "
              "never was.", "x - held(x, y >= 3) <= 2", operands=(N, C, N), optional=1, latex="", tense=Tense.PAST,
              reach=None, definition=d.held, dense=dense.held, expansion=_held, pastified=_past_held, strict=True,
              keeps=(0, 2)),
    _function("delay", 2, "The first operand d ago; the second, or its first value, where that is before the start.",
              "x - delay[2](x) <= 2", optional=1, latex="", tense=Tense.PAST, bounds=Bounds.DURATION,
              definition=d.delay, dense=dense.delay, expansion=_delay, pastified=_past_delay, strict=True, keeps=(0, 1)),
    _function("ahead", 1, "The operand d ahead; where the trace ends before, its last value.",
              "ahead[2](x) - x <= 2", latex="", tense=Tense.FUTURE, bounds=Bounds.DURATION,
              definition=d.ahead, dense=dense.ahead, kernel=Ahead(), twin="", strict=True, keeps=(0,)),
    _function("diff", 1, "The operand minus what it was d ago, or at the start.", "diff[2](x) <= 2", latex="",
              tense=Tense.PAST, bounds=Bounds.DURATION, definition=d.diff, dense=dense.diff, expansion=_diff,
              strict=True),
    _function("rate", 1, "The change of the operand in the last d, a second: diff[d](x) / d.", "rate[2](x) <= 1",
              latex="", tense=Tense.PAST, bounds=Bounds.DURATION, definition=d.rate, dense=dense.rate,
              expansion=_rate, strict=True, positive=True, timed=True),
    # ---- one sample away ---------------------------------------------------------------------
    _prefix("prev", "prev Y previous", 70, "One sample ago; holds where there is none.", "prev(x >= 3)",
            latex=r"\mathbf{{Y}} {0}", tense=Tense.PAST, reach=1, discrete_only=True,
            definition=d.prev, kernel=Shift(inf), dual="s_prev", guards=("implies",)),
    _prefix("next", "next X", 70, "One sample ahead; holds where there is none.", "next(x >= 3)",
            latex=r"\mathbf{{X}} {0}", tense=Tense.FUTURE, reach=1, discrete_only=True,
            definition=d.next_, kernel=Shift(inf), dual="s_next", twin=""),
    _prefix("s_prev", "s_prev sY s_previous", 70, "One sample ago; fails where there is none.", "s_prev(x >= 3)",
            latex=r"\mathbf{{Y}}_s {0}", tense=Tense.PAST, reach=1, discrete_only=True,
            definition=d.s_prev, kernel=Shift(-inf), dual="prev", guards=("and",)),
    _prefix("s_next", "s_next sX", 70, "One sample ahead; fails where there is none.", "s_next(x >= 3)",
            latex=r"\mathbf{{X}}_s {0}", tense=Tense.FUTURE, reach=1, discrete_only=True,
            definition=d.s_next, kernel=Shift(-inf), dual="next", twin=""),
    # ---- two operands in time ----------------------------------------------------------------
    _infix("until", "until U", 60, "The second within the window ahead, the first at every instant before it.",
           "x >= 3 until[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{U}}_{I}}} {1}",
           tense=Tense.FUTURE, bounds=Bounds.OPTIONAL, definition=d.until, dense=dense.until, kernel=Until(),
           twin="precedes"),
    _infix("precedes", "precedes", 58, "until, read from as far behind as the interval reaches.",
           "x >= 3 precedes[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{P}}_{I}}} {1}",
           tense=Tense.PAST, bounds=Bounds.REQUIRED, definition=d.precedes, dense=dense.precedes, kernel=Until(),
           guards=("implies", "and")),
    _infix("unless", "unless W", 55, "Either the first throughout [0, b], or the first until the second.",
           "x >= 3 unless[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{W}}_{I}}} {1}",
           tense=Tense.FUTURE, bounds=Bounds.OPTIONAL, definition=d.unless, dense=dense.unless, expansion=_unless),
    _infix("since", "since S", 50, "The second within the window behind, the first at every instant after it.",
           "x >= 3 since[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{S}}_{I}}} {1}",
           tense=Tense.PAST, bounds=Bounds.OPTIONAL, definition=d.since, dense=dense.since, kernel=Since(),
           guards=(None, "and")),
    # ---- edges -------------------------------------------------------------------------------
    _function("rise", 1, "Holds now and not one sample (in dense time one tick) ago, or at the start.", "rise(x >= 3)",
              operands=(F,), result=F, latex=r"\uparrow {0}", tense=Tense.PAST, reach=1, one_tick=True,
              definition=d.rise, dense=dense.rise, expansion=_rise),
    _function("fall", 1, "Held one sample (in dense time one tick) ago and does not now, or fails at the start.",
              "fall(x >= 3)", operands=(F,), result=F, latex=r"\downarrow {0}", tense=Tense.PAST, reach=1, one_tick=True,
              definition=d.fall, dense=dense.fall, expansion=_fall),
))  # fmt: skip
