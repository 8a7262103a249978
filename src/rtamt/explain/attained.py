"""At which cells of a window its largest or smallest value is attained."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt.lazy.modules import np
from rtamt.signals.instants import Cells

if TYPE_CHECKING:
    from rtamt.signals.instants import StepFunction


def attained(
    asked: Cells,
    values: StepFunction,
    operand: StepFunction,
    before: int,
    after: int,
    *,
    largest: bool,
    whole: bool,
) -> Cells:
    """Return cells, one in [k + before, k + after] for each k of ``asked``, at which its window attains its value.

    ``values``: of the window, its ``largest`` or else smallest value of ``operand``. From left to right, each time the
    last stretch that attains the value; of that, all that lies in the windows if ``whole``. Empty windows need none.
    """
    pieces = asked & Cells(values.changes, np.append(values.changes[1:], values.end))
    begins, ends = pieces.starts, pieces.ends
    value = values.each(begins)
    there = value != (-inf if largest else inf)
    begins, ends, value = begins[there], ends[there], value[there]
    stops = np.append(operand.changes[1:], operand.end)
    # The stretches of the operand by value, each group from left to right.
    order = np.argsort(operand.values, kind="stable")
    sorted_ = operand.values[order]
    new = np.append(True, sorted_[1:] != sorted_[:-1])
    levels, count = sorted_[new], len(order) + 1
    keys = (np.cumsum(new) - 1) * count + order
    group = np.searchsorted(levels, value) * count
    starts_of, ends_of = [], []
    while len(begins):
        newest = np.minimum(begins + after, operand.end - 1)
        latest = np.searchsorted(operand.changes, newest, side="right") - 1
        run = keys[np.searchsorted(keys, group + latest, side="right") - 1] - group
        last = np.minimum(ends, stops[run] - before) - 1  # the last k whose window this stretch still meets
        if whole:
            starts_of.append(np.maximum(operand.changes[run], begins + before))
            ends_of.append(np.minimum(stops[run], last + after + 1))
        else:
            first = np.minimum(stops[run] - 1, newest)
            starts_of.append(first)
            ends_of.append(np.maximum(first, last + before) + 1)
        begins = last + 1
        more = begins < ends
        begins, ends, group = begins[more], ends[more], group[more]
    if not starts_of:
        return Cells.of([])
    return Cells.union(np.concatenate(starts_of), np.concatenate(ends_of))
