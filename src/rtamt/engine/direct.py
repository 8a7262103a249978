"""The short way from data to robustness: one call that reads, checks and evaluates a recording."""

from __future__ import annotations

from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace


class Reading(Protocol):
    """Reads what a direct evaluation found; the recording is created on demand."""

    def trace(self, found: Any) -> DomainTrace:
        """Return the recording."""

    def signal(self, found: Any) -> Signal:
        """Return the robustness, the same object each time."""

    def samples(self, found: Any) -> int:
        """Return the number of samples of all variables, or of each where they have the same."""


class Direct(NamedTuple):
    """Evaluates one formula over recordings that need no conversion.

    ``run``: from data in a dict to what was found; None for data that have to be read, checked or evaluated in the
    general way. ``columns``: from other data and the variables to such a dict, or what else ``run`` reads; None where
    that is impossible.
    """

    run: Callable[[Any], Any]
    columns: Callable[[Any, Sequence[str]], Any]
    reading: Reading

    @staticmethod
    def maker_of(kind: type, slots: Sequence[str]) -> Callable[..., Any]:
        """Return a function that makes an instance of a class from the values of three slots, without ``__init__``."""
        from rtamt.engine.native import core

        made: Callable[..., Any] = core().instance_maker(kind, slots)
        return made
