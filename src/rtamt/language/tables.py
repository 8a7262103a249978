"""Lookup tables: ``table curve = {(0, 1), (10, 4)}``, used as a function: ``curve(x) <= 3``.

::

    table = "table" , name , "=" , "{" , point , { "," , point } , [ "," ] , "}" , [ ";" ]
    point = "(" , number , "," , number , ")"

A table is a function of the text that declares it: an operator that no language has. Between two points it is the
line through both, before the first and after the last point the value there.
"""

from __future__ import annotations

from bisect import bisect_right
from functools import lru_cache
from math import isinf

from rtamt.language.formula import Const, Formula, Span
from rtamt.language.lazy_modules import expansions
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import NAME, quoted
from rtamt.language.records import Fixity, Operator, Sort
from rtamt.language.unwritten import reaches
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.language.formula import Interval
    from rtamt.language.parsing.names import NameParser

    Array: TypeAlias = NDArray[np.float64]

#: The fewest and most points of a table: each takes about 13 instructions wherever the table is used.
_FEWEST, _MOST = 2, 10_000
#: Operators of tables that are kept, so that equal tables are one operator.
_KEPT = 1024


@dataclass(frozen=True, slots=True)
class Table:
    """The points of a table, in the order of increasing ``xs``."""

    xs: tuple[float, ...]
    ys: tuple[float, ...]

    def definition(self, x: Array) -> Array:
        """Return the values of the table at x.

        >>> Table((0.0, 10.0), (1.0, 4.0)).definition(np.array([-np.inf, 0, 5, 10, np.inf]))
        array([1. , 1. , 2.5, 4. , 4. ])
        """
        return np.array([self._at(each) for each in np.asarray(x, float).tolist()], float)

    def _at(self, x: float) -> float:
        place = bisect_right(self.xs, x) - 1
        if place < 0 or place == len(self.xs) - 1:
            return self.ys[max(place, 0)]
        (left, right), (begin, end) = self.xs[place : place + 2], self.ys[place : place + 2]
        # Rounding must not lead beyond the next point: what is between two points stays between their values.
        value = begin + (x - left) / (right - left) * (end - begin)
        return min(max(value, min(begin, end)), max(begin, end))

    def expansion(self, x: Formula, _interval: Interval | None) -> Formula:
        """Return the table in terms of simpler operators: a balanced tree of choices between lines.

        Each line stays between the values of its two points wherever x is, so that the hull of what bounds of x leave
        open is that of the table itself.
        """
        lines = [self._line(x, place) for place in range(len(self.xs) - 1)]
        values: list[Formula] = [*lines, Const(self.ys[-1])]
        return self._tree(x, values, 0, len(values))

    def _tree(self, x: Formula, values: list[Formula], begin: int, end: int) -> Formula:
        if end - begin == 1:
            return values[begin]
        middle = (begin + end) // 2
        above = reaches(x, Const(self.xs[middle]))
        return expansions.choice(
            above, self._tree(x, values, middle, end), self._tree(x, values, begin, middle)
        )

    def _line(self, x: Formula, place: int) -> Formula:
        """Return the line from a point to the next one, and the values of these before and after."""
        (left, right), (begin, end) = self.xs[place : place + 2], self.ys[place : place + 2]
        if begin == end:
            return Const(begin)
        share = STL["div"](STL["sub"](x, Const(left)), Const(right - left))
        value = STL["add"](Const(begin), STL["mul"](share, Const(end - begin)))
        return STL["min"](STL["max"](value, Const(min(begin, end))), Const(max(begin, end)))


@lru_cache(_KEPT)
def table_operator(name: str, table: Table) -> Operator:
    """Return the operator of a table; that of an equal table is the same one."""
    spelling = name if NAME.fullmatch(name) else quoted(name)
    return Operator(
        name,
        (spelling,),
        Fixity.FUNCTION,
        200,
        (Sort.NUMBER,),
        Sort.NUMBER,
        f"A table of {len(table.xs)} points: linear between them, constant before and after.",
        f"{spelling}(x) >= 1",
        definition=table.definition,
        expansion=table.expansion,
        strict=True,
        maker=(table_operator, (name, table)),
    )


def parse_table(parser: NameParser) -> Operator:
    """``table = "table" , name , "=" , "{" , point , { "," , point } , [ "," ] , "}" , [ ";" ]``."""
    parser.next()
    name = parser.next()
    if parser.language.opening(name.text) is not None:
        raise parser.error(f"'{name.text}' is an operator; give the table another name", name.span)
    parser.next()
    opening = parser.next()
    points: list[tuple[float, float]] = []
    while parser.token.text != "}":
        start = parser.token.start
        x, y = _point(parser, name.name)
        span = Span(start, parser.tokens[parser.index - 1].end)
        if points:
            _check_order(parser, points[-1], (x, y), span)
        points.append((x, y))
        if parser.token.kind == "end":
            raise parser.error("this '{' is never closed", opening.span)
        if not parser.accept(",") and parser.token.text != "}":
            raise parser.error(f"expected ',' or '}}' after the point, got {parser.token}", parser.token.span)
    closing = parser.next()
    if len(points) < _FEWEST:
        raise parser.error(
            f"a table has at least {_FEWEST} points, such as {{(0, 1), (10, 4)}}",
            Span(opening.start, closing.end),
        )
    if len(points) > _MOST:
        raise parser.error(
            f"a table has at most {_MOST:,} points, and '{name.name}' has {len(points):,}", name.span
        )
    parser.accept(";")
    xs, ys = zip(*points, strict=True)
    return table_operator(name.name, Table(xs, ys))


def _check_order(
    parser: NameParser, before: tuple[float, float], point: tuple[float, float], span: Span
) -> None:
    if not before[0] < point[0]:
        raise parser.error(
            f"the points of a table are in the order of increasing x, and {point[0]:g} is not after {before[0]:g}",
            span,
        )
    if any(isinf(b - a) for a, b in zip(before, point, strict=True)):
        raise parser.error("this point is so far from the one before that no double holds the distance", span)


def _point(parser: NameParser, name: str) -> tuple[float, float]:
    """``point = "(" , number , "," , number , ")"``."""
    values = []
    for symbol in ("(", ","):
        if not parser.accept(symbol):
            raise parser.error(
                f"expected a point of '{name}', such as (0, 1), got {parser.token}", parser.token.span
            )
        minus = -1.0 if parser.accept("-") else 1.0
        token = parser.next()
        if token.kind != "number" or isinf(float(token.text)):
            raise parser.error(f"expected a number, got {token}", token.span)
        values.append(minus * float(token.text))
    if not parser.accept(")"):
        raise parser.error(f"expected ')' after the point, got {parser.token}", parser.token.span)
    return values[0], values[1]
