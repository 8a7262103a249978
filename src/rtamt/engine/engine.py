"""The engine of a time domain: ``ENGINE`` in the folder that the time domain names."""

from __future__ import annotations

from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.engine.backend import Backend
    from rtamt.engine.online import OnlineMonitor
    from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain


#: The names of the back ends: the compiled core, and the definition in Python. The first is the default.
BACKENDS = ("cpp", "python")


@dataclass(frozen=True, slots=True)
class Engine:
    """Evaluates and monitors formulas in one time domain: ``ENGINE`` in its folder.

    ``backends``: by name, see :data:`BACKENDS`. ``monitor``: takes a formula and the time
    domain; for its settings see :class:`Monitor`. ``read``: takes data, the variables and the time domain; returns the
    recording if the data needs no conversion and is valid, else None.
    """

    backends: Mapping[str, Backend]
    monitor: Callable[..., OnlineMonitor]
    read: Callable[[Any, Sequence[str], Any], DomainTrace | None] = field(default=lambda *_given: None)


def engine_of(domain: TimeDomain | type[TimeDomain]) -> Engine:
    """Return the engine of a time domain."""
    found: Engine = domain.part("engine")
    return found
