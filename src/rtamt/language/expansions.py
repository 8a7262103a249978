"""The expansions of derived operators: (operands..., interval) to a simpler formula."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from math import inf

from rtamt.language.formula import Const, Formula, Interval
from rtamt.language.rows import operator
from rtamt.language.unwritten import AT_LEAST, BEFORE, GE, GT, PULSES
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rtamt.language.records import Known


def iff(a: Formula, b: Formula, _i: Interval | None) -> Formula:
    """``(φ -> ψ) and (ψ -> φ)``."""
    return operator("and")(operator("implies")(a, b), operator("implies")(b, a))


def xor(a: Formula, b: Formula, _i: Interval | None) -> Formula:
    """``not (φ <-> ψ)``."""
    return operator("not")(iff(a, b, None))


def unless(a: Formula, b: Formula, i: Interval | None) -> Formula:
    """``always[0,b] φ or φ until[a,b] ψ``."""
    whole = None if i is None else Interval(Fraction(0), i.end, "", i.end_unit, i.span, end_open=i.end_open)
    return operator("or")(operator("always")(a, interval=whole), operator("until")(a, b, interval=i))


def _before(a: Formula, tick: Interval | None) -> Formula:
    """Return the formula one sample, in dense time one tick, ago; it holds where there is none."""
    if tick is None:
        return operator("prev")(a)
    return operator("historically")(a, interval=replace(tick, implied=False))


def rise(a: Formula, tick: Interval | None) -> Formula:
    """``prev(not φ) and φ``."""
    return operator("and")(_before(operator("not")(a), tick), a)


def fall(a: Formula, tick: Interval | None) -> Formula:
    """``prev φ and not φ``."""
    return operator("and")(_before(a, tick), operator("not")(a))


def choice(truth: Formula, a: Formula, b: Formula) -> Formula:
    """Return the number that is ``a`` where ``truth`` is +inf and ``b`` where it is -inf.

    Where bounds leave the truth open, those of the result are the hull of both numbers: hence the third part.
    """
    both = operator("min")(a, b)
    return operator("max")(
        operator("max")(operator("min")(truth, a), operator("min")(operator("neg")(truth), b)), both
    )


# ---- numbers at other instants ------------------------------------------------------------------


def held(x: Formula, truth: Formula, *rest: Any) -> Formula:
    """Return x at the last instant where ``truth`` held; ``init`` where it never did."""
    *init, _interval = rest
    # x from the first step on; where bounds leave the truth open, the hull of both numbers.
    taken = operator("or")(truth, BEFORE(Const(-inf)))
    last = operator("since")(operator("or")(operator("neg")(taken), x), operator("and")(taken, x))
    return choice(operator("once")(truth), last, init[0]) if init else last


def delay(x: Formula, *rest: Any) -> Formula:
    """Return x one duration ago; before the start ``init``, or the first value of x."""
    *init, interval = rest
    before = operator("s_prev") if interval is None else partial(operator("once"), interval=interval)
    instead = init[0] if init else held(x, Const(-inf), None)
    return operator("or")(before(x), operator("and")(operator("neg")(before(Const(inf))), instead))


def diff(x: Formula, interval: Interval | None) -> Formula:
    """``x - delay[d](x)``."""
    return operator("sub")(x, operator("delay")(x, interval=interval))


def rate(x: Formula, interval: Interval | None) -> Formula:
    """``diff[d](x) / d``."""
    if interval is not None:
        return operator("div")(diff(x, interval), Const(float(interval.begin)))
    one_sample = Interval(Fraction(0), Fraction(0))
    return operator("div")(diff(x, interval), operator("integral")(Const(1.0), interval=one_sample))


def past_held(args: tuple[Formula, ...], _i: Interval | None, known: Known) -> Formula:
    """Return ``held`` of operands that are read where they are known."""
    x, condition, *init = args
    instead = init[0] if init else _since_when(x, known.begun)
    return operator("held")(x, operator("and")(condition, known.now), instead)


def past_delay(args: tuple[Formula, ...], i: Interval | None, known: Known) -> Formula:
    """Return ``delay`` of operands that are read where they are known."""
    x, *init = args
    instead = init[0] if init else _since_when(x, known.begun)
    return operator("if")(known.before(i), operator("delay")(x, interval=i), instead)


def _since_when(x: Formula, given: Formula) -> Formula:
    """Return x at the first instant at which ``given`` is true, from then on."""
    return operator("held")(x, operator("rise")(given))


def clip(x: Formula, lo: Formula, hi: Formula, _i: Interval | None) -> Formula:
    """``min(max(x, lo), hi)``, an error where ``lo > hi``."""
    return operator("min")(operator("max")(x, lo), AT_LEAST(hi, lo))


def wrap(x: Formula, lo: Formula, hi: Formula, _i: Interval | None) -> Formula:
    """``lo + mod(x - lo, hi - lo)``, and ``x`` itself inside [lo, hi)."""
    inside = operator("and")(GE(x, lo), GT(hi, x))
    # What is inside stays as it is; its difference from lo, which may overflow, is not computed.
    zero = Const(0.0)
    outside = operator("sub")(choice(inside, zero, x), choice(inside, zero, lo))
    turned = operator("add")(lo, operator("mod")(outside, AT_LEAST(operator("sub")(hi, lo), zero)))
    return choice(inside, x, choice(GE(turned, hi), lo, turned))


def _first(x: Formula) -> Formula:
    """Return the number that is the first value of ``x`` for ever."""
    return operator("held")(x, operator("false")())


def mean(x: Formula, *rest: Any) -> Formula:
    """``sum(x) / sum(1)``, and ``init`` where the window is empty."""
    *init, i = rest
    total, count = (operator("sum")(each, interval=i) for each in (x, Const(1.0)))
    if (i is None or (i.begin == 0 and not i.begin_open)) and not init:
        return operator("div")(total, count)
    begun = GT(count, Const(0.0))
    mean = operator("div")(total, operator("max")(count, Const(1.0)))
    return operator("if")(begun, mean, *(init or (_first(x),)))


def duration(condition: Formula, i: Interval | None) -> Formula:
    """``integral[a,b](if φ then 1 else 0)``."""
    return operator("integral")(operator("if")(condition, Const(1.0), Const(0.0)), interval=i)


def count(condition: Formula, i: Interval | None) -> Formula:
    """``sum[a,b](if rise(φ) then 1 else 0)``; in dense time, of the ticks in which ``rise(φ)`` is true."""
    begins = operator("and")(BEFORE(operator("not")(condition)), condition)
    return PULSES(operator("if")(begins, Const(1.0), Const(0.0)), interval=i)
