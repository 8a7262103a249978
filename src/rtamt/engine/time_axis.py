"""A recording divided into cells: evaluates formulas on it, and converts times to cells and back."""

from __future__ import annotations

from abc import ABC, abstractmethod

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction
    from typing import TypeAlias

    from rtamt.language.formula import Formula
    from rtamt.signals.instants import StepFunction

    #: From a function of cells for each variable to one for each formula.
    Runner: TypeAlias = Callable[[Mapping[str, StepFunction]], list[StepFunction]]


class TimeAxis(ABC):
    """The cells of a recording: ``period`` is the seconds from one to the next, ``end`` how many there are.

    Formulas go to the back end of the specification: the engine, or the definition.
    """

    period: Fraction
    end: int

    @abstractmethod
    def measured(self, formulas: Sequence[Formula]) -> list[StepFunction]:
        """Evaluate formulas over the recording."""

    @abstractmethod
    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """Prepare to evaluate core formulas (in cells) again and again, over other signals each time."""

    @abstractmethod
    def cell(self, at: Any) -> int:
        """Return the cell of a time in the caller's form; raise :class:`UsageError` outside the recording."""

    @abstractmethod
    def later(self, time: Any) -> int:
        """Return the cell of a time of this trace; it may be after the end."""

    @abstractmethod
    def time(self, cell: int) -> Any:
        """Return the time of a cell in the caller's form; None if the trace ends earlier."""

    @abstractmethod
    def show(self, cell: int) -> str:
        """Return the time of a cell for a sentence."""

    @property
    @abstractmethod
    def last(self) -> int:
        """The last cell that was recorded."""

    @abstractmethod
    def closes(self, end: int, formula: Formula, at: int) -> bool:
        """Return whether an interval of cells up to ``end`` is reported by its last cell instead of ``end``.

        It is part of the answer to why the formula has its verdict at the cell ``at``.
        """
