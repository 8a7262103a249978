"""Formulas as conditions: +inf where a formula holds and -inf where it does not, under every semantics.

A predicate is a comparison, or a number used as a formula, which holds where it is positive. Everything inside
a predicate belongs to it. ``true`` and ``false`` are not predicates.
"""

from __future__ import annotations

from rtamt.language.contents import operators_of
from rtamt.language.formula import Apply, Formula, fold, postorder
from rtamt.language.operators import Sort
from rtamt.language.parsing.grammar import is_number
from rtamt.language.unwritten import holds, is_truth
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from rtamt.language.operators import Operator


def truth(predicate: Formula) -> Formula:
    """Return the formula that is +inf where a predicate holds and -inf where it does not.

    ``>`` and ``>=`` differ at equality; a number holds where it is positive.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> truth(parse_formula("x >= 3")), truth(parse_formula("x + 1"))
    (<formula x >= 3>, <formula x + 1 > 0>)
    """
    if isinstance(predicate, Apply):
        if is_truth(predicate.op):
            return predicate
        if predicate.op.truth is not None:
            return predicate.op.truth(*predicate.args, predicate.interval)
    return holds(predicate)


def is_predicate(formula: Formula) -> bool:
    """Return whether a formula, where a formula is expected, is a predicate: a comparison or a number."""
    if not isinstance(formula, Apply) or is_number(formula) or formula.op.truth is not None:
        return True
    sorts = formula.op.operands
    return bool(sorts) and all(sort is Sort.NUMBER for sort in sorts)


def replaced(formula: Formula, replace: Callable[[Formula], Formula]) -> Formula:
    """Return the formula with each predicate replaced, other than in conditions and inside other predicates."""
    return _replace(formula, [formula], replace)[1]


def with_truths(formula: Formula) -> Formula:
    """Return the formula with its conditions replaced by their truth, +inf or -inf.

    If there is none, the result is the same object.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> chosen = with_truths(parse_formula("(if x >= 3 then x else y) > 0"))
    >>> chosen, chosen.args[0].args[0].op
    (<formula (if x >= 3 then x else y) > 0>, <operator holds_ge>)
    """
    conditions = _conditions(formula)
    return _replace(formula, conditions, truth)[0] if conditions else formula


def is_part_of_a_condition(part: Formula, formulas: Sequence[Formula]) -> bool:
    """Return whether a part of formulas is only read by its truth."""
    conditions = _conditions(*formulas)
    return part in _read_from(conditions)[1] and part not in _read_from(formulas)[1]


def read_as_conditions(*formulas: Formula) -> set[int]:
    """Return the identities of the parts of formulas that are read by their truth, other than inside predicates."""
    return _read_from(_conditions(*formulas))[0]


def read_conditions(operators: Iterable[Operator]) -> bool:
    """Return whether any of these operators reads an operand by its truth."""
    condition = Sort.CONDITION
    return any(condition in op.operands for op in operators)


def _conditions(*formulas: Formula) -> list[Formula]:
    if not read_conditions(operators_of(*formulas)):
        return []
    return [
        operand
        for node in postorder(*formulas)
        if isinstance(node, Apply) and Sort.CONDITION in node.op.operands
        for sort, operand in zip(node.op.operands, node.args, strict=False)
        if sort is Sort.CONDITION
    ]


def _read_from(places: Iterable[Formula]) -> tuple[set[int], set[Formula]]:
    """Return the identities of what is read as a formula, from these places on, and the formulas."""
    found: dict[int, Formula] = {}
    stack = list(places)
    while stack:
        node = stack.pop()
        if id(node) in found:
            continue
        found[id(node)] = node
        if isinstance(node, Apply) and not is_predicate(node):
            operands = zip(node.op.operands, node.args, strict=False)
            stack.extend(arg for sort, arg in operands if sort is Sort.FORMULA)
    return set(found), set(found.values())


def _replace(
    formula: Formula, places: Sequence[Formula], replace: Callable[[Formula], Formula]
) -> tuple[Formula, Formula]:
    """Return a formula with the predicates of ``places`` replaced: as a number, and as one of the places."""
    conditions = {id(place) for place in places if place is not formula}
    asked, _ = _read_from(places)

    def step(node: Formula, below: tuple[tuple[Formula, Formula], ...]) -> tuple[Formula, Formula]:
        if not isinstance(node, Apply):
            return node, replace(node) if id(node) in asked else node

        def rebuilt_with(*sorts: Sort) -> Formula:
            operands = zip(node.op.operands, node.args, below, strict=False)
            return rebuilt(
                node,
                tuple(
                    pair[sort in sorts and (sort is Sort.FORMULA or id(arg) in conditions)]
                    for sort, arg, pair in operands
                ),
            )

        plain = rebuilt_with(Sort.CONDITION)
        if id(node) not in asked:
            return plain, plain
        return plain, replace(plain) if is_predicate(node) else rebuilt_with(Sort.CONDITION, Sort.FORMULA)

    return fold(formula, step)


def rebuilt(node: Apply, args: tuple[Formula, ...]) -> Apply:
    """Return the node over new operands; the same object if they are the same objects."""
    old = node.args  # compared one by one: most nodes have one or two
    assert len(args) == len(old)
    for place, new in enumerate(args):
        if new is not old[place]:
            return Apply(node.op, args, node.interval, node.span)
    return node
