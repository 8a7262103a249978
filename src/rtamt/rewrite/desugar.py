"""Expand derived operators into core operators."""

from __future__ import annotations

from rtamt.language.contents import operators_of
from rtamt.language.formula import Apply, Formula, Span, fold, folds
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.truth import read_conditions, rebuilt, with_truths

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


class SourceSpan(Span):
    """The span of a rewritten node, with the formula of the text that it replaces."""

    source: Formula

    def __reduce__(self) -> tuple[Any, ...]:
        return Span, tuple(self)  # only messages need the formula, which may be deep


def desugar(formula: Formula) -> Formula:
    """Return an equivalent formula over core operators.

    An operator with neither expansion nor kernel (added with its definition alone) is kept, and evaluated
    by its definition. New nodes have the span of the operator that they expand.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> str(desugar(parse_formula("x >= 3 -> y <= 2")))
    '-(x - 3) or 2 - y'
    """
    return fold(spelled_out(formula), expand)


def written(core: Formula, formulas: Iterable[Formula]) -> Formula:
    """Return the part of ``formulas`` that a core formula was made from, for messages.

    If no part expands to the core formula, it is returned itself.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("always(x < 3)")
    >>> print(written(parse_formula("3 - x"), [formula]), "|", written(parse_formula("y"), [formula]))
    x < 3 | y
    """
    found = as_written(formulas).get(core, core)
    return found.span.source if isinstance(found.span, SourceSpan) else found


def as_written(formulas: Iterable[Formula]) -> dict[Formula, Formula]:
    """Return, for each core formula in the expansion of a part of ``formulas``, the first such part."""
    found: dict[Formula, Formula] = {}

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        expanded = expand(node, args)
        found.setdefault(expanded, node)

        def within(inner: Formula, _below: tuple[Formula, ...]) -> Formula:
            found.setdefault(inner, node)
            return inner

        _rebuild_above(expanded, {id(arg) for arg in args}, within)
        return expanded

    folds(tuple(map(with_truths, formulas)), step)
    return found


def spelled_out(formula: Formula) -> Formula:
    """Return the formula with all operators expanded that have an expansion and no definition.

    Conditions become +inf where they hold, else -inf. Every analysis of what operators read or mean starts here.
    If there is nothing to expand, the result is the same object.

    >>> from dataclasses import replace
    >>> from rtamt.language.formula import Var
    >>> from rtamt.language.operators import STL
    >>> nand = replace(STL["and"], name="nand", definition=None, kernel=None,
    ...     expansion=lambda a, b, _i: STL["not"](STL["and"](a, b)))
    >>> str(spelled_out(nand(Var("x"), Var("y"))))
    'not(x and y)'
    """
    operators = operators_of(formula)
    if all(op.definition is not None for op in operators):
        return with_truths(formula) if read_conditions(operators) else formula

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply) or node.op.definition is not None:
            return rebuilt(node, args) if isinstance(node, Apply) else node
        assert node.op.expansion is not None
        expanded = stamped(node.op.expansion(*args, node.interval), args, node.span)
        return _rebuild_above(expanded, {id(arg) for arg in args}, step)

    return with_truths(fold(formula, step))


def spelled_out_each(formulas: Sequence[Formula]) -> Sequence[Formula]:
    """Return several formulas as :func:`spelled_out` does, visiting shared parts once if there is nothing to expand."""
    operators = operators_of(*formulas)
    if all(op.definition is not None for op in operators) and not read_conditions(operators):
        return formulas
    return [spelled_out(formula) for formula in formulas]


def expand(node: Formula, args: tuple[Formula, ...]) -> Formula:
    """Expand one operator whose operands are core formulas."""
    if not isinstance(node, Apply):
        return node
    if node.op.expansion is None or node.op.kernel is not None:
        return rebuilt(node, args)
    return _expand_node(node.op.expansion(*args, node.interval), {id(arg): arg for arg in args}, node.span)


def _expand_node(node: Formula, done: dict[int, Formula], span: Span | None) -> Formula:
    """Expand a node of an expansion, which has few; ``done``: what is known, by the identity of nodes."""
    found = done.get(id(node))
    if found is None:
        if isinstance(node, Apply):
            below = tuple([_expand_node(child, done, span) for child in node.args])
            found = expand(Apply(node.op, below, node.interval, span), below)
        else:
            found = node
        done[id(node)] = found
    return found


def stamped(formula: Formula, operands: tuple[Formula, ...], span: Span | None) -> Formula:
    """Give every node above the operands the span of the operator that was expanded."""
    stop = {id(arg) for arg in operands}

    def stamp(node: Formula, args: tuple[Formula, ...]) -> Formula:
        return Apply(node.op, args, node.interval, span) if isinstance(node, Apply) else node

    return _rebuild_above(formula, stop, stamp)


def standing_for(source: Formula, formula: Formula, operands: tuple[Formula, ...]) -> Formula:
    """Return a formula whose nodes above the operands stand for ``source`` in messages."""
    if source.span is None:
        return formula
    span = SourceSpan(*source.span)
    span.source = source

    def stamp(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        here = node.span is None or node.span == span
        return Apply(node.op, args, node.interval, span) if here else rebuilt(node, args)

    return _rebuild_above(formula, {id(operand) for operand in operands}, stamp)


def _rebuild_above(
    formula: Formula,
    stop: set[int],
    step: Callable[[Formula, tuple[Formula, ...]], Formula],
    done: dict[int, Formula] | None = None,
) -> Formula:
    """Apply a step to each node of an expansion once, operands first, except for those below ``stop``.

    ``done``: what has been rebuilt, by the identity of nodes.
    """
    key = id(formula)
    if key in stop:
        return formula
    done = {} if done is None else done
    made = done.get(key)
    if made is None:
        args = formula.args if isinstance(formula, Apply) else ()
        # Expansions are a few nodes deep, so plain recursion is safe here; of a closure it would be a cycle.
        below = tuple([_rebuild_above(child, stop, step, done) for child in args])
        made = done[key] = step(formula, below)
    return made
