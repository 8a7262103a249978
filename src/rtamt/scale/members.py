"""What a requirement over the members of groups reads of a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.fleet.groups import way_of
from rtamt.readers.assemble import trace_of
from rtamt.readers.member_columns import choice_of_members
from rtamt.signals.members import bound

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.fleet.groups import Way
    from rtamt.readers.selection import Choice
    from rtamt.readers.source import Source
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


def over_members(
    source: Source,
    spec: Specification,
    choice_of: Callable[[Way], Choice],
    recording: str,
    *,
    complete: bool = False,
) -> tuple[Specification, Trace]:
    """Return the specification over the members that a recording has, and their trace.

    ``choice_of``: from the way in which it reads recordings to its columns. ``complete``: whether the variables beside
    the members need every sample.
    """
    choice = choice_of_members(spec, source, lambda over: choice_of(way_of(over)))
    data = spec.binding.applied(trace_of(source, choice))
    if complete:
        data.require_all_samples(spec.input_names)
    found = bound(data, spec.groups, spec.input_names, own_time_bases=True, source=recording)
    return spec.over(found.members), found.data
