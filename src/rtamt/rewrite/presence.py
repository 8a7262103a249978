"""``valid(x)`` where samples may be missing: a Boolean channel for each variable in a ``valid``.

On complete data ``valid(x)`` is true. Where samples may be missing, it is replaced by a variable called ``valid(x)``
that is 1 where x has a sample and 0 where it has none; recordings and monitors of partial knowledge provide it.
"""

from __future__ import annotations

from rtamt.language.formula import Apply, Var, fold, postorder
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from rtamt.language.formula import Formula


def channel_of(name: str) -> str:
    """Return the name of the channel of a variable."""
    return f"valid({name})"


def presences(*formulas: Formula) -> tuple[str, ...]:
    """Return the variables whose presence formulas read.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> presences(parse_formula("x > 3 and valid(y) or valid(y)"))
    ('y',)
    """
    asked = (node for node in postorder(*formulas) if isinstance(node, Apply) and node.op.presence)
    return tuple(
        dict.fromkeys(operand.name for node in asked for operand in node.args if isinstance(operand, Var))
    )


def tracked(formula: Formula) -> Formula:
    """Return a formula that reads the presence of variables from their channels; the same object if it asks for none.

    >>> from rtamt.language.contents import variables
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> variables(tracked(parse_formula("x > 3 and valid(y)")))
    ('x', 'valid(y)')
    """
    if not presences(formula):
        return formula

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        (operand, *_) = args or (node,)
        if node.op.presence and isinstance(operand, Var):
            channel = Var(channel_of(operand.name), operand.span, BOOLEAN)
            return Apply(TRUTH, (channel,), None, node.span)
        return rebuilt(node, args)

    return fold(formula, step)
