"""Formulas as JSON trees, stored with the text of a case and read by the adapters of other tools."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.language.formula import Apply, Const, Formula, Interval, Var, fold
from rtamt.language.quantifiers import FieldOf
from rtamt.language.shares import Share, ShareKind
from rtamt.language.tables import Table
from rtamt.rewrite.ground import ground

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.language.records import Operator


def in_steps(formula: Formula, step: Fraction) -> Formula:
    """Return a formula with closed bounds in steps, samples or ticks, instead of seconds."""

    def counted(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        bounds = node.interval
        if bounds is not None:
            share = bounds.share
            if share is not None and share.kind is ShareKind.DURATION:
                share = Share(share.amount / step, share.kind)
            end = None if bounds.end is None else bounds.end / step
            bounds = Interval(bounds.begin / step, end, share=share)
        return Apply(node.op, args, bounds)

    return fold(ground(formula, step), counted)


def tree(formula: Formula) -> dict[str, Any]:
    """Return a formula whose bounds are whole steps as a tree."""
    whole: dict[str, Any] = fold(formula, _node)
    return whole


def table_of(op: Operator) -> Table | None:
    """Return the lookup table that an operator is, if it is one."""
    table = op.maker[1][-1] if op.maker is not None else None
    return table if isinstance(table, Table) else None


def _node(node: Formula, args: tuple[Any, ...]) -> dict[str, Any]:
    if isinstance(node, FieldOf):
        return {"field": node.field, "of": node.variable}
    if isinstance(node, Var):
        return {"var": node.name}
    if isinstance(node, Const):
        return {"const": node.value}
    assert isinstance(node, Apply)
    bounds = node.interval
    ends = None if bounds is None else [int(bounds.begin), None if bounds.end is None else int(bounds.end)]
    table = table_of(node.op)
    whole = {"op": node.op.name if table is None else "table", "args": list(args), "interval": ends}
    if node.op.binder is not None:
        binder = node.op.binder
        whole |= {
            "member": binder.variable,
            "group": binder.group.name,
            "apart": list(map(list, binder.apart)),
        }
    if table is not None:
        whole["points"] = [list(point) for point in zip(table.xs, table.ys, strict=True)]
    if bounds is not None and bounds.share is not None:
        whole["share"] = [bounds.share.kind.value, str(bounds.share.amount)]
    return whole
