"""Write the text of a formula from pieces, or its beginning where it is too long.

Nothing here recurses: a formula is written from the outside in, from a stack of pieces, in time
proportional to the output. The text of a formula with shared sub-formulas may be astronomically long, so
a text beyond a limit is abbreviated: its beginning, followed by the size of the formula.
"""

from __future__ import annotations

from rtamt.language.formula import COUNTLESS, Formula, postorder, size
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    #: Text, or a formula that is still to be written.
    Piece = str | Formula

#: The longest text in characters that is written in full by default,
LONGEST = 1_000_000
#: in tables and reports,
PAGE = 10_000
#: and in a message; a longer text is cut to this length.
EXCERPT = 200


def text_of(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]], limit: int) -> str:
    """Write a formula; if the text is longer than ``limit``, its beginning and the size of the formula."""
    text = full_text(formula, pieces, limit)
    if text is not None:
        return text
    begin = ""
    for more in _texts(formula, pieces):
        begin += more
        if len(begin) >= EXCERPT:
            break
    return _abbreviated(begin, formula)


def excerpts_of(formulas: Sequence[Formula], pieces: Callable[[Formula], Iterable[Piece]]) -> tuple[str, ...]:
    """Write several formulas as :func:`text_of` does with a limit of :data:`EXCERPT`, visiting shared nodes once."""
    begins: dict[int, str] = {}
    for node in postorder(*formulas):
        begin = ""
        for piece in pieces(node):  # text, or a formula below this one
            begin += piece if isinstance(piece, str) else begins[id(piece)]
            if len(begin) > EXCERPT:
                break
        begins[id(node)] = begin[: EXCERPT + 1]
    return tuple(
        begin if size(formula) <= EXCERPT >= len(begin) else _abbreviated(begin, formula)
        for formula, begin in ((formula, begins[id(formula)]) for formula in formulas)
    )


def _abbreviated(begin: str, formula: Formula) -> str:
    return f"{begin[:EXCERPT]}… (abbreviated: {extent_of(formula)})"


def full_text(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]], limit: int) -> str | None:
    """Write a formula, given the pieces of one node; None if the text has more than ``limit`` characters."""
    if size(formula) > limit:  # every node takes at least one character
        return None
    out: list[str] = []
    for text in _texts(formula, pieces):
        out.append(text)
        limit -= len(text)
        if limit < 0:
            return None
    return "".join(out)


def _texts(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]]) -> Iterator[str]:
    stack: list[Piece] = [formula]
    while stack:
        piece = stack.pop()
        if isinstance(piece, str):
            yield piece
        else:
            stack.extend(reversed(tuple(pieces(piece))))


def extent_of(formula: Formula) -> str:
    """Return the size of a formula in words."""
    count = size(formula)
    number = f"more than {COUNTLESS:.0e}" if count == COUNTLESS else f"{count:.6g}"
    return f"{number} operators, variables and numbers"
