"""The positions of operators and operands in the text, and the edits that remove one of them.

Spans of formulas do not contain the parentheses around them, and what a name or a template stands for is written
elsewhere. So a part is found by the tokens of its operator; without them, nothing is edited.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Span
from rtamt.language.operators import Fixity
from rtamt.lint.found import Edit

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.lint.found import Text

_OPENING, _CLOSING = frozenset("([{"), frozenset(")]}")


def tokens_of(text: Text, span: Span) -> range:
    """Return the indices of the tokens inside a span."""
    tokens = text.tokens
    return range(bisect_left(tokens.starts, span.start), bisect_left(tokens.starts, span.end))


def is_prefix_here(text: Text, node: Apply) -> bool:
    """Return whether a prefix operator is at the position of its node, followed by its operand."""
    span = node.span
    if span is None or node.op.fixity is not Fixity.PREFIX:
        return False
    first = bisect_left(text.tokens.starts, span.start)
    return text.tokens.starts[first] == span.start and text.tokens.texts[first] in node.op.spellings


def operand_begins(text: Text, node: Apply) -> int:
    """Return the index of the first token behind a prefix operator and its interval."""
    assert node.span is not None
    interval = node.interval.span if node.interval is not None else None
    if interval is None:
        return bisect_left(text.tokens.starts, node.span.start) + 1
    return bisect_left(text.tokens.starts, interval.end)


def without_prefix(text: Text, node: Apply) -> Edit:
    """Return the edit that removes a prefix operator and its interval."""
    assert node.span is not None
    return Edit(Span(node.span.start, text.tokens.starts[operand_begins(text, node)]))


def is_grouped(text: Text, node: Apply) -> bool:
    """Return whether the operand of a prefix operator is in parentheses, as a whole."""
    assert node.span is not None
    first = operand_begins(text, node)
    depth, texts = 0, text.tokens.texts
    for at in range(first, tokens_of(text, node.span).stop):
        depth += (texts[at] in _OPENING) - (texts[at] in _CLOSING)
        if depth == 0:
            return at > first and text.tokens.ends[at] == node.span.end
    return False


def is_infix_here(text: Text, node: Apply) -> bool:
    """Return whether an infix operator is at the position of its node."""
    return infix_at(text, node) is not None


def infix_at(text: Text, node: Apply) -> int | None:
    """Return the index of the token of an infix operator between its operands; None if it is written elsewhere."""
    if node.span is None or node.op.fixity not in (Fixity.LEFT, Fixity.RIGHT):
        return None
    # Of a long chain the operand at this end is short, so that only it is read.
    inside, texts, depth = tokens_of(text, node.span), text.tokens.texts, 0
    for at in inside if node.op.fixity is Fixity.RIGHT else reversed(inside):
        depth += (texts[at] in _OPENING) - (texts[at] in _CLOSING)
        if depth == 0 and texts[at] in node.op.spellings:
            return at
    return None


def keep_left(text: Text, node: Apply) -> Edit | None:
    """Return the edit that removes an infix operator and its right operand."""
    at = infix_at(text, node)
    assert node.span is not None
    return None if not at else Edit(Span(text.tokens.ends[at - 1], node.span.end))


def keep_right(text: Text, node: Apply) -> Edit | None:
    """Return the edit that removes an infix operator and its left operand."""
    at = infix_at(text, node)
    assert node.span is not None
    return None if at is None else Edit(Span(node.span.start, text.tokens.starts[at + 1]))


def chain_operands(node: Apply) -> list[Formula]:
    """Return the operands of a chain of one infix operator, from left to right."""
    found: list[Formula] = []
    first: Formula = node
    while isinstance(first, Apply) and first.op is node.op:
        found.append(first.args[1])
        first = first.args[0]
    return [first, *reversed(found)]
