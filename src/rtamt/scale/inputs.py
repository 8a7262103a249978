"""The fields of a message for the variables of a specification, or of the requirements of a suite."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.fleet.suite import Suite
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.value_types import ValueType
    from rtamt.specification import Specification


class Input(NamedTuple):
    """A variable: its ``name``, the fields that may hold it, the first of which counts, and its type."""

    name: str
    columns: tuple[str, ...]
    type: ValueType | None


def inputs_of(spec: Specification | Suite) -> tuple[Input, ...]:
    """Return the variables of a specification or of all requirements, one for each recorded name.

    >>> import rtamt
    >>> inputs_of(rtamt.parse('input float v = "speed"; v <= 30'))
    (Input(name='v', columns=('speed',), type=None),)
    """
    specs = spec.specifications.values() if isinstance(spec, Suite) else [spec]
    found: dict[str, Input] = {}
    for one in specs:
        columns, others = dict(one.binding.columns), dict(one.binding.others)
        for name in one.input_names:
            new = Input(name, (columns.get(name, name), *others.get(name, ())), one.types.get(name))
            known = found.setdefault(new.columns[0], new)
            if known[1:] != new[1:]:
                raise UsageError(
                    f"'{new.columns[0]}' has different declarations in the requirements of the suite: declare it alike"
                )
    return tuple(found.values())


def is_dense(spec: Specification | Suite, settings: Mapping[str, Any]) -> bool:
    """Return whether each variable has its own samples; ``settings``: those of a fleet."""
    if isinstance(spec, Suite):
        return all(way.domain.own_time_bases for way in spec.ways)
    return spec._domain_for(settings.get("time"), None, None, None).own_time_bases
