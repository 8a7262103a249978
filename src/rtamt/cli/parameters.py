"""``--set NAME=VALUE``: values of the parameters of specifications."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.settings import assignments, require_parameters

if TYPE_CHECKING:
    from argparse import _ActionsContainer
    from collections.abc import Sequence

    from rtamt.specification import Specification


def add_set_option(group: _ActionsContainer) -> None:
    """Add the option that sets parameters."""
    group.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="the value of a parameter that the specification declares; repeatable",
    )


def assigned(specs: Sequence[Specification], given: Sequence[str]) -> list[Specification]:
    """Return specifications with these values; each name must be a parameter of one of them."""
    values = assignments(given)
    known = dict.fromkeys(name for spec in specs for name in spec.parameters)
    require_parameters(values, known)
    return [
        spec.with_parameters(**{name: value for name, value in values.items() if name in spec.parameters})
        for spec in specs
    ]
