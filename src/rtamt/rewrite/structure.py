"""The structure of a formula for explanations: predicates under minimum and maximum, also over time.

A formula is split into *predicates* (leaves, as the user wrote them) under operators whose value is
always that of one of their operands at some instant, or its negation. After desugaring these are the kernels
min, max, neg, windows, shares of them, shifts, since and until. No operator is named here. An operator not
composed of these (added with a definition alone, or with arithmetic over formulas) is a leaf as a whole.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, TypeGuard

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Interval, Span, Var, fold, postorder
from rtamt.language.operators import STL
from rtamt.language.records import Bounds, Pointwise, Rank, Shift, Since, Sort, Tense, Until, Window
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.rewrite.desugar import desugar

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

#: Later than every cell (a sample, in dense time a tick), and small enough that a few of them still add up
#: within 64 bits.
NEVER = 2**60

#: Opcodes of the instructions that select one of their operands.
CHOOSING = ("min", "max")
NEGATION = "neg"

#: A sub-formula, and whether it is under an even (+1) or odd (-1) number of negations.
Place = tuple[Formula, int]


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """A predicate of the user's formula; ``fixed`` if it reads no variable."""

    name: str
    formula: Formula
    fixed: bool


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """A core formula over variables for predicates, and these predicates.

    ``core`` is expressed in cells (see :func:`in_cells`); ``order`` holds its distinct sub-formulas,
    operands first. ``polar`` is the formula at each place with every predicate split into two variables, one
    for its occurrences under an even number of negations and one for the others: it is nondecreasing in
    the first and nonincreasing in the second.
    """

    core: Formula
    leaves: Mapping[str, Leaf]
    order: tuple[Formula, ...]
    polar: Mapping[Place, Formula]

    @classmethod
    def of(cls, formula: Formula, tick: Fraction | None) -> Structure:
        """Analyse a formula; ``tick`` is the length of a tick in dense time, None in discrete time."""
        skeleton, leaves = _over_leaves(formula)
        core = desugar(skeleton)
        if tick is not None:
            core = in_cells(core)
        order = tuple(dict.fromkeys(postorder(core)))
        return cls(core, leaves, order, _polar(order, leaves))


def literal(name: str, sign: int) -> str:
    """Return the variable for a predicate at places of one sign."""
    return f"{name}{'+' if sign > 0 else '-'}"


def opcode(node: Formula) -> str | None:
    """Return the opcode of a pointwise node of a core formula; None if it reads other instants."""
    kernel = node.op.kernel if isinstance(node, Apply) else None
    return kernel.opcode if isinstance(kernel, Pointwise) else None


# ---- leaves ------------------------------------------------------------------------------------


def _over_leaves(formula: Formula) -> tuple[Formula, dict[str, Leaf]]:
    """Return the formula with each distinct predicate replaced by a variable, and the predicates."""
    names: dict[Formula, str] = {}
    rebuilt: dict[int, Formula] = {}
    stack: list[tuple[Formula, bool]] = [(formula, False)]
    while stack:
        node, ready = stack.pop()
        if id(node) in rebuilt:
            continue
        if not _is_connective(node):
            if isinstance(node, Const) and abs(node.value) == float("inf"):
                rebuilt[id(node)] = node
            else:
                rebuilt[id(node)] = Var(names.setdefault(node, f"#{len(names)}"), node.span)
        elif ready:
            rebuilt[id(node)] = replace(node, args=tuple(rebuilt[id(arg)] for arg in node.args))
        else:
            stack.append((node, True))
            stack.extend((arg, False) for arg in reversed(node.args))
    leaves = {name: Leaf(name, leaf, not variables(leaf)) for leaf, name in names.items()}
    return rebuilt[id(formula)], leaves


def _is_connective(node: Formula) -> TypeGuard[Apply]:
    """Return whether a node's value is always that of one of its operands at some instant, or its negation."""
    if not isinstance(node, Apply) or node.op.result is Sort.NUMBER or node.op.truth is not None:
        return False
    if any(sort is not Sort.FORMULA for sort in node.op.operands):
        return False
    operands = tuple(Var(f"#{k}") for k in range(len(node.args)))
    return all(map(_is_structural, postorder(desugar(replace(node, args=operands)))))


def _is_structural(node: Formula) -> bool:
    if not isinstance(node, Apply):
        return True
    kernel = node.op.kernel
    if isinstance(kernel, Pointwise):
        return kernel.opcode in (*CHOOSING, NEGATION)
    return isinstance(kernel, Window | Rank | Shift | Since | Until)


def _polar(order: tuple[Formula, ...], leaves: Mapping[str, Leaf]) -> dict[Place, Formula]:
    polar: dict[Place, Formula] = {}
    for node in order:
        for sign in (1, -1):
            if isinstance(node, Apply):
                below = -sign if opcode(node) == NEGATION else sign
                polar[node, sign] = replace(node, args=tuple(polar[arg, below] for arg in node.args))
            elif isinstance(node, Var) and not leaves[node.name].fixed:
                polar[node, sign] = Var(literal(node.name, sign), node.span)
            else:
                polar[node, sign] = node
    return polar


# ---- cells -------------------------------------------------------------------------------------


def in_cells(formula: Formula) -> Formula:
    """Convert a dense-time core formula to one with the same meaning when its ticks are read as samples.

    Windows of right-continuous signals need no change. ``φ since ψ`` requires φ on the rest of the
    tick at which ψ held, unless that is the present one; ``φ until[a,b] ψ`` with a > 0 requires it up to
    and including the tick that is a ahead.
    """

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        node = replace(node, args=args)
        begin, end = bounds_of(node)
        if isinstance(node.op.kernel, Since):
            later = replace(node, args=(args[0], STL["and"](*args)))
            return later if begin else _set_span(STL["or"](args[1], later), node.span)
        if isinstance(node.op.kernel, Until) and begin:
            rest = replace(node, interval=Interval(Fraction(0), None if end is None else end - begin))
            if node.op.tense is Tense.PAST:
                assert end is not None
                return _conjunction("historically", args[0], (end - begin, end), rest, node.span)
            moved = STL["eventually"](rest, interval=Interval(begin, begin))
            return _conjunction("always", args[0], (Fraction(0), begin), moved, node.span)
        return node

    return fold(formula, step)


def _conjunction(
    window: str, hold: Formula, bounds: tuple[Fraction, Fraction], rest: Formula, span: Span | None
) -> Formula:
    return _set_span(STL["and"](STL[window](hold, interval=Interval(*bounds)), rest), span)


def _set_span(node: Apply, span: Span | None) -> Apply:
    return replace(node, span=span)


def bounds_of(node: Apply) -> tuple[Fraction, Fraction | None]:
    """Return the bounds of an operator in seconds; no interval is [0, inf)."""
    return (Fraction(0), None) if node.interval is None else (node.interval.begin, node.interval.end)


def window_of(node: Apply, period: Fraction) -> tuple[int, int]:
    """Return the bounds of an operator in cells of ``period`` seconds; ``NEVER`` if unbounded."""
    begin, end = bounds_of(node)
    return min(int(begin / period), NEVER), NEVER if end is None else min(int(end / period), NEVER)


def reaches(order: tuple[Formula, ...], period: Fraction) -> dict[Formula, tuple[int, int]]:
    """Return the number of cells that each sub-formula can read behind and ahead, ``NEVER`` at most."""
    found: dict[Formula, tuple[int, int]] = {}
    for node in order:
        behind = ahead = 0
        if isinstance(node, Apply):
            own = own_reach(node, period)
            behind = own[0] + max((found[arg][0] for arg in node.args), default=0)
            ahead = own[1] + max((found[arg][1] for arg in node.args), default=0)
        found[node] = min(behind, NEVER), min(ahead, NEVER)
    return found


def settling(formulas: Iterable[Formula], period: Fraction) -> int:
    """Return how many cells from the nearest change of a signal core formulas are constant at the latest.

    There an operator without an upper bound has one value, too: that of its operand and of what lies beyond the
    change; only its lower bound counts.
    """
    found: dict[Formula, int] = {}
    for node in postorder(*formulas):
        own = 0
        if isinstance(node, Apply):
            bounded = max(own_reach(node, period))
            own = bounded if bounded < NEVER else window_of(node, period)[0] + node.op.before
            own += max((found[arg] for arg in node.args), default=0)
        found[node] = own
    return max(found.values(), default=0) + 1


def own_reach(node: Apply, period: Fraction) -> tuple[int, int]:
    """Return the number of cells that an operator reads its operands behind and ahead."""
    if node.op.tense is Tense.NONE:
        return 0, 0
    if node.op.bounds is Bounds.NONE:
        reach = NEVER if node.op.reach is None else node.op.reach
    else:
        reach = window_of(node, period)[1] + node.op.before
    return (reach, 0) if node.op.tense is Tense.PAST else (0, reach)
