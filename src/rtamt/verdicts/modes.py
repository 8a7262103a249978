"""The verdict modes: what a monitor reports of a formula. THE LIST of them.

``Specification.monitor(verdict=...)``, ``rtamt monitor --verdict``, their errors and the reference read it.
"""

from __future__ import annotations

from types import MappingProxyType

from rtamt.errors import UsageError, choices, shown
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.time_domains import DOMAINS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.verdicts.early.monitor import EarlyMonitor


@dataclass(frozen=True, slots=True)
class Mode:
    """The verdict modes of monitors. The part of the time domain with the name of the mode is its monitor."""

    name: str
    doc: str
    #: The settings of the mode alone, by name, as ``Specification.monitor`` takes them.
    settings: tuple[str, ...] = ()
    #: Whether predicates are true or false, and not a distance.
    boolean: bool = False
    #: Whether samples may be missing, or known as bounds only.
    inexact: bool = False


MODES: Mapping[str, Mode] = MappingProxyType(
    {
        mode.name: mode
        for mode in (
            Mode(
                "delayed",
                "the robustness at each sample, one horizon later",
                settings=("episodes", "worst_case"),
            ),
            Mode(
                "eager",
                "whether the formula holds at each sample, as soon as no later sample can change it",
                settings=("ranges", "explain"),
                boolean=True,
                inexact=True,
            ),
            Mode(
                "interval",
                "bounds of the robustness, from what is known by now",
                settings=("at", "ranges", "lateness", "on_correction"),
                inexact=True,
            ),
            Mode(
                "causation",
                "by how much each sample alone violates or satisfies the formula",
            ),
        )
    }
)

DELAYED = "delayed"


def mode_of(verdict: Any, settings: Mapping[str, Any]) -> Mode:
    """Return a mode; raise :class:`UsageError` for any other name, or a setting that it does not have.

    ``settings``: those of modes that were given, by name.

    >>> mode_of("eager", {}).doc
    'whether the formula holds at each sample, as soon as no later sample can change it'
    """
    if not isinstance(verdict, str) or verdict not in MODES:
        raise UsageError(f"verdict is {shown(verdict)}{choices(verdict, MODES, 'verdicts')}")
    mode = MODES[verdict]
    for name in settings:
        if name not in mode.settings:
            modes = " or ".join(f"'{each.name}'" for each in MODES.values() if name in each.settings)
            raise UsageError(f"{name}= belongs to verdict={modes}, and this is verdict='{verdict}'")
    return mode


def monitor_of(mode: Mode, domain: TimeDomain) -> Callable[..., EarlyMonitor]:
    """Return the monitor of a mode in a time domain; raise :class:`UsageError` if there is none."""
    found: Callable[..., EarlyMonitor] | None = domain.part(mode.name)
    if found is None:
        choices = " or ".join(name for name, each in DOMAINS.items() if mode.name in each.parts)
        raise UsageError(f"verdict='{mode.name}' needs {choices} time; use it, or verdict='{DELAYED}'")
    return found


def semantics_in(mode: Mode, semantics: str | PredicateSemantics) -> str | PredicateSemantics:
    """Return the semantics whose sign settles the verdicts of a mode.

    Whether a formula holds is the same under every semantics, as for ``Result.satisfied``; ``>=`` and ``>`` differ
    at equality.

    >>> semantics_in(MODES["eager"], "standard"), semantics_in(MODES["eager"], "output_robustness")
    ('boolean', 'boolean')
    """
    return "boolean" if mode.boolean else semantics
