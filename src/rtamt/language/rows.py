"""Rows of the operator table: shorthands for operators of one notation, and an operator by its name."""

from __future__ import annotations

from functools import cache, partial

from rtamt.language.lazy_modules import dimensions
from rtamt.language.lazy_modules import function_enclosures as fe
from rtamt.language.lazy_modules import functions as f
from rtamt.language.records import (
    Fixity,
    Operator,
    Pointwise,
    Sort,
)
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.units.rules import UnitRule

#: The sorts of operands and results.
N, F, C = Sort.NUMBER, Sort.FORMULA, Sort.CONDITION


@cache
def operator(name: str) -> Operator:
    """Return an operator of the table, for functions that the table itself refers to."""
    from rtamt.language.operators import STL

    return STL[name]


def function(name: str, arity: int, doc: str, example: str, **more: Any) -> Operator:
    """Return an operator written ``name(x, y)``."""
    more.setdefault("latex", rf"\mathrm{{{{{name}}}}}({', '.join(f'{{{k}}}' for k in range(arity))})")
    more.setdefault("operands", (N,) * arity)
    more.setdefault("result", N)
    return Operator(name, (name,), Fixity.FUNCTION, 200, doc=doc, example=example, **more)


def infix(name: str, spellings: str, power: int, doc: str, example: str, **more: Any) -> Operator:
    """Return an operator written between its operands."""
    more.setdefault("operands", (F, F))
    more.setdefault("result", F)
    return Operator(
        name,
        tuple(spellings.split()),
        more.pop("fixity", Fixity.LEFT),
        power,
        doc=doc,
        example=example,
        **more,
    )


def prefix(name: str, spellings: str, power: int, doc: str, example: str, **more: Any) -> Operator:
    """Return an operator written before its operand."""
    more.setdefault("operands", (F,))
    more.setdefault("result", F)
    return Operator(name, tuple(spellings.split()), Fixity.PREFIX, power, doc=doc, example=example, **more)


def slopes(*known: int | None) -> Callable[..., tuple[int | None, ...]]:
    """Return a function from the values of constant operands to the monotonicity of the result in each operand.

    1: nondecreasing; -1: nonincreasing; 0: neither, and the extension is still as narrow as possible
    if no variable occurs twice; None: the extension may be wider than that.
    """
    return lambda *_constants: known


def same_unit(*which: int) -> UnitRule:
    """Return the rule of operators whose operands, or those of these numbers, have one unit, that of the result."""
    return partial(dimensions.agree, which=which)


def math(
    name: str,
    doc: str,
    example: str,
    *known: int | None,
    definition: Any = None,
    rising: bool = False,
    **more: Any,
) -> Operator:
    """Return a mathematical function; its definition and opcode have its name, and its extension unless ``rising``.

    ``known``: see :func:`slopes`. ``rising``: it is nondecreasing, and computed without error or rounded correctly.
    """
    definition = definition or getattr(f, name)
    more["extension"] = partial(fe.rising, definition) if rising else getattr(fe, name)
    more["kernel"] = Pointwise(name, more.pop("partial", False))
    more["strict"] = True
    return function(name, len(known), doc, example, definition=definition, slopes=slopes(*known), **more)
