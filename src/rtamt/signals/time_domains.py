"""The list of time domains; command line, messages and documentation derive from it."""

from __future__ import annotations

from types import MappingProxyType

from rtamt.errors import UsageError, choices, shown
from rtamt.language.units.durations import NANOSECOND
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import Discrete
from rtamt.signals.sampling_period import TOLERANCE
from rtamt.signals.time_domain_interface import TimeDomain

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from rtamt.language.units.durations import Duration

_LISTED: dict[str, type[TimeDomain]] = {domain.name: domain for domain in (Discrete, Dense)}

#: By name, in the order of their codes in programs; the first is the default.
DOMAINS: Mapping[str, type[TimeDomain]] = MappingProxyType(_LISTED)

#: The name of the default time domain.
DEFAULT = next(iter(DOMAINS))


class Defaults(NamedTuple):
    """Defaults of the settings of a time domain."""

    period: Fraction | None = None
    tolerance: float = TOLERANCE
    resolution: Fraction = NANOSECOND


_DEFAULTS = Defaults()


def time_domain(
    time: Any,
    period: Duration | None = None,
    tolerance: float | None = None,
    resolution: Duration | None = None,
    defaults: Defaults = _DEFAULTS,
) -> TimeDomain:
    """Return a time domain given by name with its settings, or as an object.

    Raises :class:`UsageError` for anything else, and for settings in addition to an object.

    >>> time_domain("discrete", tolerance=0.5)
    Discrete(period=None, tolerance=0.5)
    """
    if isinstance(time, TimeDomain):
        given = {"period": period, "tolerance": tolerance, "resolution": resolution}
        extra = [f"{name}=" for name, value in given.items() if value is not None]
        if extra:
            raise UsageError(f"time is {time!r}, which has its own settings: leave out {' and '.join(extra)}")
        return time
    if not isinstance(time, str) or time not in DOMAINS:
        names = tuple(DOMAINS)
        raise UsageError(f"unknown time domain {shown(time)}{choices(time, names, 'time domains')}")
    return DOMAINS[time].of(
        defaults.period if period is None else period,
        defaults.tolerance if tolerance is None else tolerance,
        defaults.resolution if resolution is None else resolution,
    )
