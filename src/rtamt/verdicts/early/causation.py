"""Online: by how much what became known last alone violates or satisfies a formula.

The monitors are in ``discrete_causation.py`` and ``dense_causation.py``.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from rtamt.errors import SpecificationError, TraceError, UsageError, shown
from rtamt.language.printing.printer import excerpt
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.early import causeless
from rtamt.verdicts.early.monitor import EarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.engine import Watched
    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import Causation, CausationRun
    from rtamt.signals.time_domain_interface import TimeDomain


def _check_causes(formula: Formula, text: str | None, watch: Sequence[Watched]) -> None:
    """Raise :class:`SpecificationError` for a formula without causation."""
    for each, source in ((formula, text), *((w.formula, w.text) for w in watch)):
        culprit = causeless(each)
        if culprit is not None:
            raise SpecificationError(
                f"'{excerpt(culprit)}' is a share of a window, which has no causation; use another verdict mode",
                source,
                culprit.span,
            )


def not_exact(name: str, given: Any, index: int, moment: str) -> TraceError:
    """Return the error for a sample that is missing or uncertain."""
    return TraceError(
        f"'{name}' is {shown(given)} at sample {index}, {moment}, and causation needs exact samples: give a number, "
        f"or monitor with verdict='interval'",
        variable=name,
        index=index,
    )


class CausationMonitor(EarlyMonitor):
    """The base of the monitors of causation."""

    _reports_causes = True

    def __init__(self, formula: Formula, domain: TimeDomain, **settings: Any) -> None:
        _check_causes(formula, settings.get("text"), settings.get("watch", ()))
        self._bounded = unbounded_future(formula) is None
        super().__init__(formula, domain, start=True, every=self._bounded, **settings)
        self._forget()
        self._prepare()

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> Causation:
            """Take values at one instant; return what they cause at the start of the trace."""

    @abstractmethod
    def finish(self) -> Causation | None:
        """End the trace; return what that causes at the start, None if it causes nothing."""

    @abstractmethod
    def runs(self) -> list[CausationRun]:
        """Return the runs of instants for which the last call caused something, also later than the newest sample."""

    def _require_bounded_past(self) -> None:
        if not self._bounded:
            raise UsageError(
                "a formula of unbounded future has causation at the start of the trace alone; call causation()"
            )
