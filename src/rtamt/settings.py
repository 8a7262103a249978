"""The keyword arguments of :func:`rtamt.parse`, defined once, and the errors for invalid values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from enum import Enum
from fractions import Fraction
from math import inf, isinf, isnan
from types import MappingProxyType

from rtamt.engine import BACKENDS, engine_of
from rtamt.errors import UsageError, choices, did_you_mean, shown
from rtamt.language.contents import variables
from rtamt.language.formula import Formula
from rtamt.language.operators import Language
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias
from rtamt.rewrite.semantics import ROLES, PredicateSemantics
from rtamt.signals.arrays import is_number, is_truth

if TYPE_CHECKING:
    from collections.abc import Collection
    from typing import TypedDict

    from rtamt.language.document import Document
    from rtamt.language.units.durations import Duration
    from rtamt.language.value_types import ValueType
    from rtamt.signals.time_domain_interface import TimeDomain

#: A name, a member of an enumeration whose text is a name, or a function of a predicate and roles.
Semantics: TypeAlias = str | Enum | PredicateSemantics

#: Formulas that a monitor evaluates in addition to its own: names, texts or formulas.
Watch: TypeAlias = str | Formula | Iterable[str | Formula]


#: More decimal digits than the least and the greatest double are away from 1.
_DIGITS = 330
_NUMBER = lazy_pattern(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_INFINITE = lazy_pattern(r"[+-]?inf")

#: The names of the settings of :meth:`Specification.evaluate` that functions pass on.
EVALUATION_SETTINGS = ("time", "period", "resolution", "semantics", "time_unit")

if TYPE_CHECKING:  # annotations alone name them, and Python would compile each of theirs

    class EvaluationSettings(TypedDict, total=False):
        """The settings of :meth:`Specification.evaluate`, for functions that pass them on."""

        time: str | TimeDomain | None
        period: Duration | None
        resolution: Duration | None
        semantics: Semantics | None
        time_unit: str | None

    class Settings(TypedDict, total=False):
        """The keyword arguments of :func:`rtamt.parse`, for functions that pass them on."""

        period: Duration | None
        unit: str
        backend: str
        constants: Mapping[str, float] | None
        language: Language
        time: str | TimeDomain
        resolution: Duration
        semantics: Semantics
        roles: Mapping[str, str] | None

    class OnlineSettings(TypedDict, total=False):
        """The settings of every monitor, see :meth:`Specification.monitor`."""

        semantics: Semantics | None
        watch: Watch
        time_unit: str | None

    class DiscreteSettings(OnlineSettings, total=False):
        """Those of a monitor of discrete time."""

        period: Duration | None
        tolerance: float | None
        worst_case: bool

    class DenseSettings(OnlineSettings, total=False):
        """Those of a monitor of dense time."""

        resolution: Duration | None

    class IntervalSettings(DiscreteSettings, DenseSettings, total=False):
        """Those of a monitor of bounds in either time domain."""

        at: str | None
        ranges: Mapping[str, Any] | None
        lateness: Duration | None
        on_correction: str | None


def require_samples(domain: TimeDomain, *, worst_case: bool) -> None:
    """Raise :class:`UsageError` if constant time per sample is requested in a domain without samples."""
    if worst_case and not domain.sampled:
        raise UsageError(
            "worst_case=True needs discrete time: in dense time a window may hold any number of changes; "
            "leave it out, or use time='discrete'"
        )


def check_language(language: Language) -> None:
    """Raise :class:`UsageError` unless the value is a language."""
    if not isinstance(language, Language):
        raise UsageError(f"language is {shown(language)}, expected a Language: STL or STL.extend(...)")


def check_backend(backend: str) -> None:
    """Raise :class:`UsageError` unless the back end exists."""
    if backend not in BACKENDS:
        raise UsageError(f"unknown backend {shown(backend)}{choices(backend, BACKENDS, 'back ends')}")


def require_backend(backend: str, domain: TimeDomain) -> None:
    """Raise :class:`UsageError` unless the back end can run in this installation."""
    engine_of(domain).backends[backend].require()


def check_constants(constants: Mapping[str, float]) -> None:
    """Raise :class:`UsageError` unless every constant is a number."""
    _check_mapping("constants", constants, "{'limit': 3}")
    for name, value in constants.items():
        if not is_number(value) or isnan(value):
            raise UsageError(f"the constant '{name}' is {shown(value)}; give a number")


def assignments(texts: Iterable[str]) -> dict[str, float | str]:
    """Return parameter values from texts; texts that are not numbers are kept for :func:`parameter_value`.

    Numbers are those of formulas, with a sign: Python also reads ``1_0`` and digits of other scripts. Raises
    :class:`UsageError` for a text that sets nothing, and for a parameter that is set twice.

    >>> assignments(["limit=3", "battery.low = 3.5", "strict=true", "start=AUTO"])
    {'limit': 3.0, 'battery.low': 3.5, 'strict': True, 'start': 'AUTO'}
    """
    truths = {"true": True, "false": False}
    values: dict[str, float | str] = {}
    for text in texts:
        name, equals, given = text.rpartition("=")
        name, value = name.strip(), given.strip()
        if not equals or not name or not value:
            raise UsageError(f"'{text}' sets no parameter; write NAME=VALUE, such as limit=3")
        if name in values:
            raise UsageError(f"the parameter '{name}' is set twice; leave out one of the values")
        truth = truths.get(value.lower())
        values[name] = _number(value) if truth is None else truth
    return values


def _number(text: str) -> float | str:
    """Return the number that a text is in formulas, which are finite unless they are ``inf``; else the text."""
    if _INFINITE.fullmatch(text):
        return float(text)
    number = float(text) if _NUMBER.fullmatch(text) else inf
    return text if isinf(number) else number


def require_parameters(names: Iterable[str], known: Collection[str]) -> None:
    """Raise :class:`UsageError` unless every name is that of a known parameter."""
    for name in names:
        first = name.partition("=")[0].strip()
        if name not in known and first in known and first != name:
            raise UsageError(f"'{name}' names several parameters; set each by itself, such as {first}=3")
        if name not in known:
            declared = (
                choices(name, known, "parameters") if known else f"; declare it: parameter float {name} = ..."
            )
            raise UsageError(f"there is no parameter '{name}'{declared}")


def parameter_value(name: str, given: Any, type_: ValueType | None, *, whole: bool = False) -> float:
    """Return the value of a parameter as a number; raise :class:`UsageError` for a value of another type.

    A number that is no double, such as ``Fraction(1, 3)``, is an :class:`~rtamt.language.exact_number.ExactNumber`.
    ``whole``: whether it is declared as a whole number.

    >>> mode = Enumeration("Mode", (("MANUAL", 0), ("AUTO", 4)))
    >>> parameter_value("start", "AUTO", mode), parameter_value("strict", True, BOOLEAN)
    (4.0, 1.0)
    """
    from rtamt.language.exact_number import as_double

    if isinstance(type_, Enumeration):
        return _code(name, given, type_)
    given = _rational(given)
    if not is_number(given) or isnan(given):
        needed = "it is a bool, so give true or false" if type_ is BOOLEAN else "give a number"
        raise UsageError(f"the parameter '{name}' is {shown(given)}; {needed}")
    truth = is_truth(given)
    if type_ is BOOLEAN and not truth and given not in (0, 1):
        raise UsageError(f"the parameter '{name}' is {shown(given)}; it is a bool, so give true or false")
    if type_ is None and truth:
        raise UsageError(f"the parameter '{name}' is {shown(given)}, and it is no bool; give a number")
    if whole and not float(given).is_integer():
        raise UsageError(
            f"the parameter '{name}' is {shown(given)}, and declared as a whole number; declare it as float"
        )
    return as_double(given)


def _rational(given: Any) -> Any:
    """Return a Decimal in the range of doubles as a fraction; everything else unchanged."""
    from decimal import Decimal

    if not isinstance(given, Decimal) or not given.is_finite() or given.adjusted() > _DIGITS:
        return given
    return Fraction(given) if given.adjusted() > -_DIGITS else 0.0


def _code(name: str, given: Any, type_: Enumeration) -> float:
    """Return the code of a member that is given by its name, as a member of a Python ``enum``, or by its code."""
    member = given.name if isinstance(given, Enum) else given
    if isinstance(member, str):
        member = member.removeprefix(f"{type_.name}.")
        code = type_.code(member)
        if code is None:
            raise UsageError(
                f"the parameter '{name}' is {shown(member)}, which is {type_.unknown_member(member)}"
            )
        return float(code)
    if not is_number(given) or is_truth(given) or type_.member(given) is None:
        raise UsageError(
            f"the parameter '{name}' is {shown(given)}, which is no member of {type_.name}; "
            f"its members are {type_.listing()}"
        )
    return float(given)


def _check_mapping(what: str, given: object, example: str) -> None:
    if not isinstance(given, Mapping):
        raise UsageError(
            f"{what} is {shown(given)}, expected a mapping from name to value, such as {example}"
        )


def roles_of(document: Document, given: Mapping[str, str]) -> Mapping[str, str]:
    """Return the roles that a document declares, overridden by those that are given.

    Raises :class:`UsageError` for a name that the document does not define, and for an invalid role.
    """
    _check_mapping("roles", given, "{'req': 'input'}")
    declared = {d.name: d.role for d in document.declarations if d.role is not None}
    read = set(variables(*(assertion.formula for assertion in document.assertions))) if given else set()
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


def watched_of(watch: Watch) -> tuple[str | Formula, ...]:
    """Return the watched formulas without duplicates; raise :class:`UsageError` unless given texts or formulas."""
    try:
        given = (watch,) if isinstance(watch, str | Formula) else tuple(watch)
    except TypeError:
        raise _wrong_watch(watch) from None
    if not all(isinstance(each, str | Formula) for each in given):
        raise _wrong_watch(watch)
    return tuple(dict.fromkeys(given))


def _wrong_watch(watch: Watch) -> UsageError:
    return UsageError(f"watch is {shown(watch)}, expected names or formulas, such as ['x >= 3']")
