"""Operators that no text contains: truths of predicates, and parts of expansions."""

from __future__ import annotations

from math import inf

from rtamt.language.formula import Const, Formula
from rtamt.language.lazy_modules import dense
from rtamt.language.lazy_modules import discrete as d
from rtamt.language.lazy_modules import enclosures as e
from rtamt.language.lazy_modules import function_enclosures as fe
from rtamt.language.lazy_modules import functions as f
from rtamt.language.lazy_modules import pointwise as p
from rtamt.language.records import (
    Bounds,
    Fixity,
    Operator,
    Pointwise,
    Shift,
    Sum,
    Tense,
)
from rtamt.language.rows import C, F, N, function, infix, operator, prefix, slopes
from rtamt.lazy.typing import Any


def _truth(code: str, spelling: str, symbol: str, definition: Any, **more: Any) -> Operator:
    if not more:
        more = {
            "kernel": Pointwise(f"holds_{code}"),
            "extension": getattr(e, f"holds_{code}"),
            "slopes": slopes(0, 0) if code == "eq" else slopes(1, -1),
        }
    doc, example = f"+inf where a {spelling} b, else -inf.", f"x {spelling} 3"
    latex = f"{{0}} {symbol} {{1}}"
    return infix(
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
GT, GE = _truth("gt", ">", ">", p.holds_gt), _truth("ge", ">=", r"\geq", p.holds_ge)
EQ = _truth("eq", "==", "=", p.holds_eq)
LE = _truth("le", "<=", r"\leq", p.holds_le, expansion=lambda a, b, _i: operator("not")(GT(a, b)))
LT = _truth("lt", "<", "<", p.holds_lt, expansion=lambda a, b, _i: operator("not")(GE(a, b)))
NE = _truth("ne", "!=", r"\neq", p.holds_ne, expansion=lambda a, b, _i: operator("not")(EQ(a, b)))

#: A Boolean (1 or 0) read as a formula: +inf where it is true, else -inf. Not written: it prints as its operand.
TRUTH = Operator(
    "truth", ("true",), Fixity.FUNCTION, 200, (N,), F, "+inf where a Boolean is true, else -inf.", "p", latex="{0}",
    definition=p.true_where, expansion=lambda a, _i: holds(a),
)  # fmt: skip
#: Operators that are +inf or -inf, outside the table.
_TRUTHS = (GT, GE, EQ, LE, LT, NE, TRUTH)


# The first operand where it is at least the second, else undefined; not part of the language either.
AT_LEAST = function(
    "at_least", 2, "The first operand, which must be at least the second.", "at_least(x, 3) > 5",
    definition=f.at_least, kernel=Pointwise("at_least", partial=True), extension=fe.at_least,
    slopes=slopes(1, 0),
)  # fmt: skip

#: Whether the member of a group is present, from its channel: +inf or -inf under every semantics.
PRESENT = Operator(
    "present", ("valid",), Fixity.FUNCTION, 200, (C,), F, "+inf where a member is present, else -inf.", "p",
    latex="{0}", definition=p.true_where, expansion=lambda a, _i: a,
)  # fmt: skip
#: The third operand where a member is present, else the second, which saves the operation that reads it from
#: having no value. Not written: it prints as its third operand.
WHERE_PRESENT = Operator(
    "where_present", ("if",), Fixity.FUNCTION, 200, (C, N, N), N, "The third operand where a member is present.", "x",
    latex="{2}", definition=lambda c, b, a: p.if_(c, a, b), expansion=lambda c, b, a, _i: operator("if")(c, a, b),
    keeps=(2,),
)  # fmt: skip


#: What the members of a group give together, under the chosen semantics; the second operand is positive where the
#: quantifier holds.
COLUMN = Operator(
    "column", ("column",), Fixity.FUNCTION, 200, (N, N), F, "The first operand.", "x", latex="{0}",
    definition=lambda x, _holds: x, expansion=lambda x, _holds, _i: x, truth=lambda _x, positive, _i: holds(positive),
)  # fmt: skip

#: By name, for unpickling.
UNWRITTEN = {op.name: op for op in (*_TRUTHS, AT_LEAST, PRESENT, WHERE_PRESENT, COLUMN)}


# The operand one step before, a sample or a tick; +inf at the start. Not part of the language.
BEFORE = prefix(
    "before", "before", 70, "One step ago.", "before(x >= 3)", tense=Tense.PAST, reach=1, one_tick=True,
    definition=d.prev, dense=dense.historically, kernel=Shift(inf),
)  # fmt: skip

# The sum of a number that is 1 for a sample or tick, and else 0. Not part of the language.
PULSES = function(
    "pulses", 1, "The number of pulses in the window behind.", "pulses(x)", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
    definition=d.sum_, dense=dense.pulses, before=1, kernel=Sum(),
)  # fmt: skip


def is_truth(op: Operator) -> bool:
    """Return whether an operator by itself is +inf or -inf."""
    return op.presence or any(op is each for each in _TRUTHS)


def holds(number: Formula) -> Formula:
    """Return the formula that is +inf where ``number`` is positive, else -inf."""
    return GT(number, Const(0.0))


def reaches(number: Formula, least: Formula) -> Formula:
    """Return the formula that is +inf where ``number`` is at least ``least``, else -inf."""
    return GE(number, least)
