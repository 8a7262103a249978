"""The engine of each time domain: its back ends and its monitor."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.engine.dense import backends as dense
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.discrete import backends as discrete
from rtamt.engine.discrete.monitor import Monitor
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.engine.backend import Backend
    from rtamt.engine.online import OnlineMonitor
    from rtamt.signals.domain_interface import TimeDomain


@dataclass(frozen=True, slots=True)
class Engine:
    """What evaluates and monitors formulas in one time domain.

    ``backends``: by name, see :data:`rtamt.engine.backend.BACKENDS`. ``monitor``: takes a formula and the time
    domain; for its settings see :class:`Monitor`.
    """

    backends: Mapping[str, Backend]
    monitor: Callable[..., OnlineMonitor]


_ENGINES: Mapping[type[TimeDomain], Engine] = MappingProxyType(
    {
        Discrete: Engine(discrete.BACKENDS, Monitor),
        Dense: Engine(dense.BACKENDS, DenseMonitor),
    }
)


def engine_of(domain: TimeDomain) -> Engine:
    """Return the engine of a time domain."""
    return _ENGINES[type(domain)]
