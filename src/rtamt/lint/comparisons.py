"""Rules about comparisons of the same number with several constants, and conditions that are tested twice."""

from __future__ import annotations

from math import inf, isfinite
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const
from rtamt.language.operators import STL, Source
from rtamt.language.parsing.grammar import is_predicate
from rtamt.language.printing.printer import excerpt
from rtamt.language.unwritten import EQ, NE
from rtamt.lazy.tuples import NamedTuple
from rtamt.lint.edits import chain_operands, is_infix_here, keep_left, keep_right
from rtamt.lint.found import Fix, Found
from rtamt.lint.structure import JUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rtamt.language.formula import Formula
    from rtamt.language.operators import Operator
    from rtamt.lint.found import Text

#: The comparisons with the signs of the bounds that each gives its left operand: 1 a lower bound, -1 an upper one.
_BOUNDS = {
    STL["ge"]: (1,),
    STL["gt"]: (1,),
    STL["le"]: (-1,),
    STL["lt"]: (-1,),
    STL["eq"]: (1, -1),
    EQ: (1, -1),
}
_STRICT = (STL["gt"], STL["lt"])
#: The negations of comparisons; members of enumerations are compared by truth.
_NEGATED = {**{op: STL[op.dual] for op in STL if op.dual and is_predicate(op)}, NE: EQ}


class Bound(NamedTuple):
    """A number is at least (``sign`` 1) or at most (-1) a constant; ``strict``: and not equal."""

    number: Formula
    sign: int
    limit: float
    strict: bool
    comparison: Apply

    def beyond(self, other: Bound) -> bool:
        """Return whether no number has both bounds, which are in opposite directions."""
        gap = (self.limit - other.limit) * self.sign
        return gap > 0 or (gap == 0 and (self.strict or other.strict))


class Chain(NamedTuple):
    """A chain of ``and`` or ``or``: its last operator, and the bounds of numbers that have several; negated, too."""

    root: Apply
    bounds: list[list[Bound]]
    negated: list[list[Bound]]


def _bounds(operand: Formula, *, negated: bool) -> Iterator[Bound]:
    """Yield the bounds that a comparison with a constant gives a number; those of its negation."""
    if not isinstance(operand, Apply) or len(operand.args) != 2:
        return
    op = _NEGATED.get(operand.op) if negated else operand.op
    if op not in _BOUNDS:
        return
    left, right = operand.args
    side = 1
    if type(left) is Const:
        left, right, side = right, left, -1
    if type(right) is not Const or isinstance(left, Const) or not isfinite(right.value):
        return
    for sign in _BOUNDS[op]:
        yield Bound(left, sign * side, right.value, op in _STRICT, operand)


def chains_of(text: Text) -> list[Chain]:
    """Return each chain of ``and`` or ``or`` that has two bounds of one number."""
    inner = {id(node.args[0]) for node in text.of(JUNCTIONS) if _is(node.args[0], node.op)}
    found = []
    for node in text.of(JUNCTIONS):
        if id(node) not in inner:
            operands = chain_operands(node)
            plain, negated = (_repeated_bounds(operands, negated=each) for each in (False, True))
            if plain or negated:
                found.append(Chain(node, plain, negated))
    return found


def _is(formula: Formula, op: Operator) -> bool:
    return isinstance(formula, Apply) and formula.op is op


def _repeated_bounds(operands: Sequence[Formula], *, negated: bool) -> list[list[Bound]]:
    """Return the bounds of each number that has several."""
    bounds = [bound for operand in operands for bound in _bounds(operand, negated=negated)]
    if len(bounds) < 2:
        return []
    found: dict[Formula, list[Bound]] = {}
    for bound in bounds:
        found.setdefault(bound.number, []).append(bound)
    return [each for each in found.values() if len(each) > 1]


def _exclusive_bounds(text: Text, neutral: float) -> Iterator[tuple[Apply, Bound, Bound]]:
    """Yield the chains of one operator in which two bounds exclude each other, negated in those of ``or``."""
    for chain in text.chains:
        if JUNCTIONS[chain.root.op] != neutral:
            continue
        for bounds in chain.negated if neutral < 0 else chain.bounds:
            lower = [each for each in bounds if each.sign > 0]
            upper = [each for each in bounds if each.sign < 0]
            pair = next(((a, b) for a in lower for b in upper if a.beyond(b)), None)
            if pair is not None:
                yield chain.root, *pair


def _quote_comparisons(text: Text, a: Bound, b: Bound) -> tuple[str, str]:
    """Return two comparisons for a message: as they are written, or printed where one use of a template is both."""
    if a.comparison.span == b.comparison.span:
        return f"'{excerpt(a.comparison)}'", f"'{excerpt(b.comparison)}'"
    return text.written(a.comparison.span), text.written(b.comparison.span)


def contradiction(text: Text) -> Iterator[Found]:
    """``x > 5 and x < 3``, ``mode == AUTO and mode == RTL``."""
    for node, a, b in _exclusive_bounds(text, inf):
        pair = " and ".join(_quote_comparisons(text, a, b))
        yield Found(node.span, f"{pair} never hold at the same instant")


def tautology(text: Text) -> Iterator[Found]:
    """``x < 5 or x > 3``, ``mode != AUTO or mode != RTL``."""
    for node, a, b in _exclusive_bounds(text, -inf):
        pair = " or ".join(_quote_comparisons(text, b, a))
        yield Found(node.span, f"one of {pair} always holds")


def weaker_comparison(text: Text) -> Iterator[Found]:
    """``x > 3 and x > 5``, where the first one changes nothing."""
    for root, every, _ in text.chains:
        conjunction = JUNCTIONS[root.op] > 0
        parents = _parents(root) if every else {}
        for bounds in every:
            one_sided = [each for each in bounds if len(_BOUNDS[each.comparison.op]) == 1]
            for sign in (1, -1):
                same = [each for each in one_sided if each.sign == sign]
                if len(same) < 2:
                    continue
                # Of a conjunction the tightest bound decides, of a disjunction the loosest.
                by = sign if conjunction else -sign
                decisive = max(same, key=lambda each: (each.limit * by, each.strict == conjunction))
                for bound in same:
                    if bound.limit == decisive.limit:
                        continue
                    weaker, tighter = _quote_comparisons(text, bound, decisive)
                    yield Found(
                        bound.comparison.span,
                        f"{weaker} changes nothing beside {tighter}; remove it",
                        _removal(text, parents.get(id(bound.comparison), ()), bound.comparison),
                    )


def _parents(root: Apply) -> dict[int, list[Apply]]:
    """Return the nodes of a chain, outermost first, by the identity of each of their operands."""
    found: dict[int, list[Apply]] = {}
    node = root
    while True:
        left, right = node.args
        for operand in (right, left):
            found.setdefault(id(operand), []).append(node)
        if not isinstance(left, Apply) or left.op is not root.op:
            return found
        node = left


def _removal(text: Text, parents: Iterable[Apply], operand: Apply) -> Fix | None:
    """Return the fix that removes an operand of a chain; ``parents``: the nodes of which it is an operand."""
    for node in parents:
        if is_infix_here(text, node):
            left, right = node.args
            edit = keep_left(text, node) if right is operand else keep_right(text, node)
            return None if edit is None else Fix((edit,), node, left if right is operand else right)
    return None


def branch_tested_before(text: Text) -> Iterator[Found]:
    """``if p then x else (if p then y else z)``, where ``y`` is never taken."""
    for node in text.of(op for op in text.by_operator if op.source is Source.BRANCH):
        condition = node.args[0]
        for number, branch in enumerate(node.args[1:]):
            inner = branch
            while isinstance(inner, Apply) and inner.op is node.op:
                if inner.args[0] == condition:
                    dead = inner.args[2 - number]
                    yield Found(
                        inner.span,
                        f"{text.written(condition.span)} was tested before, so that {text.written(dead.span)} is "
                        f"never reached",
                    )
                inner = inner.args[2]
