"""Online: bounds of the robustness and the verdict of a formula at the start of the trace."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rtamt.settings import Semantics
    from rtamt.signals.outcomes import Interval
    from rtamt.specification import Specification
    from rtamt.verdicts.early.interval import IntervalMonitor

#: What is known of a verdict, in the words of all outputs.
OPEN, SATISFIED, VIOLATED, SAFE = "open", "satisfied", "violated", "can no longer be violated"


class StartMonitor:
    """Bounds of the robustness at the start of the trace, and whether the formula holds there.

    ``settings``: those of ``Specification.monitor(verdict="interval")``. The verdict is that of Boolean predicates,
    so that it is also decided where the robustness is 0.

    >>> import rtamt
    >>> monitor = StartMonitor(rtamt.parse("always(x > 0)"))
    >>> for t, x in enumerate([3, 0]):
    ...     monitor.update(t, x=x)
    >>> monitor.interval(), monitor.satisfied, monitor.decided_at, monitor.status
    (Interval(lower=-inf, upper=0.0), False, 1, 'violated')
    """

    def __init__(self, spec: Specification, *, semantics: Semantics | None = None, **settings: Any) -> None:
        self.bounds: IntervalMonitor = spec.monitor(
            verdict="interval", at="start", semantics=semantics, **settings
        )
        self.truth: IntervalMonitor = spec.monitor(
            verdict="interval", at="start", semantics="boolean", **settings
        )
        self.reset()

    @property
    def samples(self) -> int:
        """The number of samples so far."""
        return self.bounds.samples

    @property
    def input_names(self) -> tuple[str, ...]:
        """The variables that the formula reads."""
        return self.bounds.input_names

    def reset(self) -> None:
        """Forget the trace; the next sample is the first."""
        self.bounds.reset()
        self.truth.reset()
        self.finished = False
        self.satisfied: bool | None = None
        #: The time of the sample that decided the verdict, as it was given; None while it is open, or if the end did.
        self.decided_at: Any = None

    def update(self, time: Any, /, **values: Any) -> None:
        """Take a sample; errors and arguments as for :class:`IntervalMonitor`."""
        self.bounds.update(time, **values)  # fails where the other would
        self.truth.update(time, **values)
        self.refresh(time)

    def finish(self) -> None:
        """End the trace."""
        self.bounds.finish()
        self.truth.finish()
        self.finished = True
        self.refresh(None)

    def interval(self) -> Interval:
        """Return the bounds."""
        return self.bounds.interval()

    def refresh(self, time: Any) -> None:
        """Update the verdict after a sample, which both monitors have taken."""
        truth = self.truth.interval()
        satisfied = True if truth.lower > 0 else False if truth.upper < 0 else None
        if satisfied != self.satisfied:
            self.satisfied, self.decided_at = satisfied, time

    @property
    def status(self) -> str:
        """The state of the verdict, in words."""
        if self.satisfied is None:
            return OPEN
        if not self.satisfied:
            return VIOLATED
        bounds = self.interval()
        return SATISFIED if bounds.lower == bounds.upper else SAFE
