"""The warning for formulas that RTAMT parses differently: chains such as ``a -> b -> c`` and ``1 < x < 3``.

In RTAMT every infix operator is left-associative; here some are right-associative, as marked in the operator
table, and comparisons in one direction are conjunctions. Parsing the text a second time with RTAMT's rules shows
whether the difference matters.
"""

from __future__ import annotations

import warnings
from functools import cache
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Formula, fold, postorder
from rtamt.language.operators import STL, Fixity, Language
from rtamt.language.parsing.grammar import is_chain
from rtamt.language.printing.printer import excerpt
from rtamt.lazy.dataclasses import replace

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.document import Document


def warn_of_chains(document: Document, read: Callable[[str, Language], Document], stacklevel: int) -> None:
    """Warn of each assertion of ``document`` that RTAMT would have parsed differently.

    ``read`` parses a text in a language; ``stacklevel`` is that of :func:`warnings.warn`.
    """
    if not _may_differ(*(assertion.formula for assertion in document.assertions)):
        return
    theirs = read(document.text, _left_to_right())
    for ours, other in zip(document.assertions, theirs.assertions, strict=True):
        formula = fold(other.formula, _as_theirs)
        if formula != ours.formula:
            warnings.warn(
                f"a chain without parentheses is read as '{excerpt(ours.formula)}'; RTAMT read it as "
                f"'{excerpt(formula)}': write the one that is meant",
                stacklevel=stacklevel,
            )


@cache
def _left_to_right() -> Language:
    return Language.of(replace(op, fixity=Fixity.LEFT) if op.fixity is Fixity.RIGHT else op for op in STL)


def _may_differ(*formulas: Formula) -> bool:
    """Return whether a right-associative operator has an operand with the same operator, or comparisons chain."""
    return any(
        (_to_the_right(node) and any(map(_to_the_right, node.args))) or is_chain(node)
        for node in postorder(*formulas)
        if isinstance(node, Apply)
    )


def _to_the_right(node: Formula) -> bool:
    return isinstance(node, Apply) and node.op.fixity is Fixity.RIGHT


def _as_theirs(node: Formula, args: tuple[Formula, ...]) -> Formula:
    """Return a formula of the language that is read from left to right, as RTAMT reads it, in the operators here."""
    if not isinstance(node, Apply):
        return node
    if is_chain(node):
        left, last = args
        assert isinstance(last, Apply)
        return Apply(last.op, (left, last.args[1]), None, node.span)
    return Apply(STL[node.op.name], args, node.interval, node.span)
