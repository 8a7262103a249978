"""Declarations of data in specifications: whether the analysis covers them, and whether two specifications agree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis.encoder import Limits, NotCoveredError
from rtamt.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.specification import Specification


def require_covered(spec: Specification) -> None:
    """Raise :class:`NotCoveredError` for a time domain without samples, and for groups of signals."""
    if not spec.domain.sampled:
        raise NotCoveredError(
            f"{spec.domain.name} time is not covered by the analysis, which counts samples: read the specification in "
            f"discrete time"
        )
    if spec.groups:
        name = next(iter(spec.groups))
        raise NotCoveredError(
            f"quantifiers are not covered by the analysis: choose the members of '{name}' with spec.over(...)"
        )


def last_limits(specs: Sequence[Specification]) -> Mapping[str, Limits]:
    """Return the declared limits of variables; those of later specifications replace those of earlier ones."""
    return {name: limits for spec in specs for name, limits in _declared(spec).items()}


def common_limits(specs: Sequence[Specification]) -> Mapping[str, Limits]:
    """Return the limits of variables, which hold for the signals and thus for each of the specifications.

    One that only one of them declares holds for both. Raises :class:`UsageError` if they declare different ones.
    """
    found: dict[str, Limits] = {}
    for spec in specs:
        for name, limits in _declared(spec).items():
            known = found.get(name, Limits())
            for what in Limits._fields:
                own, other = getattr(limits, what), getattr(known, what)
                if own is not None and other is not None and own != other:
                    _differ(what, name)
            found[name] = Limits(limits.range or known.range, limits.rate or known.rate)
    return found


def _declared(spec: Specification) -> Mapping[str, Limits]:
    return {
        each.name: Limits(each.range, each.rate) for each in spec.document.declarations if each.kind == "var"
    }


def require_same_signals(specs: Sequence[Specification]) -> None:
    """Raise unless a variable has one type, and one unit: data in another unit are other numbers."""
    types: dict[str, object] = {}
    units: dict[str, str] = {}
    for spec in specs:
        for name in spec.input_names:
            type_ = spec.types.get(name)
            unit = spec.units.get(name, units.get(name, ""))
            if types.setdefault(name, type_) != type_:
                _differ("type", name)
            if units.setdefault(name, unit) not in ("", unit):
                _differ("unit", name)
            units[name] = unit


def _differ(what: str, name: str) -> None:
    raise UsageError(f"the {what}s of '{name}' differ: declare the same {what} in both specifications")
