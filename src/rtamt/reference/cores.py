"""The core of a formula for the definitions that evaluate it again with every sample."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Var, postorder
from rtamt.language.operators import Pointwise
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.check import check_dense
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.ground import ground
from rtamt.rewrite.horizon import horizons

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from rtamt.language.formula import Formula

#: How many formulas are remembered.
_KEPT = 256


class Core(NamedTuple):
    """A formula over core operators, and the horizon of each of its parts by their identity, in steps."""

    formula: Formula
    horizons: Mapping[int, int | None]


class Identity:
    """A formula as this very object: equal formulas have different positions in the text."""

    __slots__ = ("formula",)

    def __init__(self, formula: Formula) -> None:
        self.formula = formula

    def __hash__(self) -> int:
        return id(self.formula)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Identity) and other.formula is self.formula


def core_of(formula: Formula, step: Fraction, *, continuous: bool = False) -> Core:
    """Return the core of a formula, see :func:`ground`; raise what :func:`check_dense` raises in dense time.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> str(core_of(parse_formula("x >= 3 -> y <= 2"), Fraction(1)).formula)
    '-(x - 3) or 2 - y'
    """
    return _core(Identity(formula), step, continuous)


@lru_cache(_KEPT)
def _core(same: Identity, step: Fraction, continuous: bool) -> Core:
    if continuous:
        check_dense(same.formula)
    core = desugar(ground(same.formula, step, continuous=continuous))
    depths = {
        part: None if depth is None else int(depth / step) for part, depth in horizons(core, step).items()
    }
    return Core(core, depths)


def inside_predicates(formula: Formula) -> set[int]:
    """Return the identities of the operands within the parts of a core formula that read variables at one instant.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> core = core_of(parse_formula("once[0:2](x >= 3)"), Fraction(1)).formula
    >>> len(inside_predicates(core))  # x and 3, but not x - 3
    2
    """
    local: dict[int, bool] = {}
    inside: set[int] = set()
    for node in postorder(formula):
        local[id(node)] = isinstance(node, Const | Var) or (
            isinstance(node, Apply)
            and isinstance(node.op.kernel, Pointwise)
            and all(local[id(operand)] for operand in node.args)
        )
        if local[id(node)] and isinstance(node, Apply):
            inside.update(map(id, node.args))
    return inside
