"""Rows of the operator table: shorthands for operators of one notation, and an operator by its name."""

from __future__ import annotations

from functools import cache

from rtamt.language.definitions import enclosures as e
from rtamt.language.definitions import function_enclosures as fe
from rtamt.language.definitions import functions as f
from rtamt.language.records import (
    Fixity,
    Operator,
    Pointwise,
    Sort,
)
from rtamt.lazy.typing import Any

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


def math(
    name: str, doc: str, example: str, *slopes: int | None, definition: Any = None, **more: Any
) -> Operator:
    """Return a mathematical function; its definition, extension and opcode have its name."""
    definition = definition or getattr(f, name)
    more["extension"] = getattr(fe, name, None) or fe.rising(definition)
    more["kernel"] = Pointwise(name, more.pop("partial", False))
    more["strict"] = True
    return function(name, len(slopes), doc, example, definition=definition, slopes=e.slopes(*slopes), **more)
