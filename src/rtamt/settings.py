"""What :func:`rtamt.parse` takes besides the text: one list, and what is said of a wrong setting."""

from __future__ import annotations

from enum import Enum
from fractions import Fraction
from math import isnan
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias, TypedDict

from rtamt.engine.signals import is_number
from rtamt.errors import UsageError, did_you_mean, shown
from rtamt.language.formula import variables
from rtamt.language.units import duration
from rtamt.rewrite.interface import ROLES, Judge

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.operators import Language
    from rtamt.language.specfile import Document

BACKENDS = ("cpp", "python")
TIMES = ("discrete", "dense")

#: Seconds, or text with a unit, such as ``"100ms"``.
Duration: TypeAlias = str | float | Fraction
#: A name, a member of an enumeration whose text is a name, or a function of a predicate and roles.
Semantics: TypeAlias = str | Enum | Judge


class Settings(TypedDict, total=False):
    """The keyword arguments of :func:`rtamt.parse`, for functions that pass them on."""

    period: Duration | None
    unit: str
    backend: str
    constants: Mapping[str, float] | None
    language: Language
    time: str
    resolution: Duration
    semantics: Semantics
    roles: Mapping[str, str] | None


class Reading(TypedDict, total=False):
    """How :meth:`Specification.evaluate` reads a recording, for functions that pass it on."""

    time: str | None
    period: Duration | None
    resolution: Duration | None
    semantics: Semantics | None


def check_backend(backend: str) -> None:
    """Raise :class:`UsageError` unless there is such a back end."""
    if backend not in BACKENDS:
        raise UsageError(
            f"unknown backend '{backend}'{did_you_mean(backend, BACKENDS)}; choose from {', '.join(BACKENDS)}"
        )


def check_constants(constants: Mapping[str, float]) -> None:
    """Raise :class:`UsageError` unless every constant is a number."""
    for name, value in constants.items():
        if not is_number(value) or isnan(value):
            raise UsageError(f"the constant '{name}' is {shown(value)}; give a number")


def time_domain(time: str) -> str:
    """Return a time domain's name; raise :class:`UsageError` for any other text."""
    if time not in TIMES:
        raise UsageError(
            f"unknown time domain '{time}'; choose from {', '.join(TIMES)}{did_you_mean(time, TIMES)}"
        )
    return time


def positive_period(period: Duration) -> Fraction:
    """Return a sampling period in seconds, exact."""
    exact = duration(period)
    if exact <= 0:
        raise UsageError(f"the sampling period is {period!r}; it must be positive")
    return exact


def roles_of(document: Document, given: Mapping[str, str]) -> Mapping[str, str]:
    """Return the roles that a document declares, and before them those that are given.

    Raises :class:`UsageError` for a name that the document does not know, and for what is no role.
    """
    declared = {d.name: d.role for d in document.declarations if d.role is not None}
    read = {name for assertion in document.assertions for name in variables(assertion.formula)}
    known = read | {name.split(".")[0] for name in read} | {d.name for d in document.declarations}
    for name, role in given.items():
        if name not in known:
            raise UsageError(
                f"roles has '{name}', which the specification neither reads nor declares"
                f"{did_you_mean(str(name), sorted(known))}"
            )
        if role not in ROLES:
            raise UsageError(f"the role of '{name}' is {shown(role)}; choose 'input' or 'output'")
    return MappingProxyType({**declared, **given})
