"""The interfaces of time domains and of traces in them, implemented by ``discrete`` and ``dense``."""

from __future__ import annotations

from abc import ABC, abstractmethod

from rtamt.language.units.durations import NANOSECOND
from rtamt.lazy import import_module
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar
from rtamt.rewrite.ground import grounds
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.sampling_period import TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence
    from fractions import Fraction

    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from rtamt.language.formula import Formula
    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.language.units.durations import Duration
    from rtamt.rewrite.check import BoundUnit
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.coding import Types
    from rtamt.signals.signal import Signal

    Bounds = tuple[FloatArray, FloatArray]
    Mask = NDArray[np.bool_]


class TimeDomain(ABC):
    """A time domain: the step in which bounds are counted, and the conversion of data to a trace.

    Immutable; ``rtamt.Discrete(...)`` and ``rtamt.Dense(...)``. What evaluates and monitors formulas in a
    time domain is its engine (``rtamt.engine.Engine``), one of its ``parts``.
    """

    __slots__ = ()

    #: As in ``time="discrete"``.
    name: ClassVar[str]
    #: Its description in help texts.
    summary: ClassVar[str]
    #: Whether signals have values between their samples.
    continuous: ClassVar[bool]
    #: Whether a recording has one sample of every variable per period.
    sampled: ClassVar[bool]
    #: Whether each variable has its own timestamps, so that variables and requirements may start at different times.
    own_time_bases: ClassVar[bool]
    #: Whether signals hold their last values after the end of a recording, which then cuts no window.
    held_at_end: ClassVar[bool]
    #: How bounds are counted, and what messages call their step.
    unit: ClassVar[BoundUnit]
    #: The setting that is the length of a step.
    setting: ClassVar[str]
    #: What higher layers have for this time domain, as ``module:name`` by purpose: the required ``engine``,
    #: ``stream`` (checks in chunks), ``early_check`` (``rtamt check --early``), ``ros_groups`` (what ROS nodes run),
    #: ``replay`` (the samples of a recording, for plots of bounds), and a monitor for each verdict mode.
    parts: ClassVar[Mapping[str, str]]

    @classmethod
    def part(cls, purpose: str) -> Any:
        """Import what a higher layer has for this time domain; None where it has nothing."""
        place = cls.parts.get(purpose)
        if place is None:
            return None
        module, name = place.split(":")
        return getattr(import_module(module), name)

    # Settings; those that do not concern a time domain have their defaults.
    #: The sampling period in seconds; None if there is none, or where it depends on the timestamps.
    period: Fraction | None = None
    #: The fraction of the period by which a gap between samples may differ from it.
    tolerance: float = TOLERANCE
    #: The length of a tick in seconds.
    resolution: Fraction = NANOSECOND

    @classmethod
    @abstractmethod
    def of(cls, period: Duration | None, tolerance: float, resolution: Duration) -> TimeDomain:
        """Return the time domain with those of the settings that concern it."""

    @property
    @abstractmethod
    def step(self) -> Fraction | None:
        """Seconds of one step: the sampling period or a tick; None where that depends on the timestamps."""

    @property
    @abstractmethod
    def online(self) -> Self:
        """The time domain of a monitor, whose step is known before the first timestamp."""

    @abstractmethod
    def check(self, formula: Formula, text: str | None = None) -> Formula:
        """Return the formula as :meth:`ground` does; raise :class:`BoundError` or :class:`SpecificationError`.

        Bounds are not checked while the step is unknown; :meth:`DomainTrace.check` does that.
        """

    def ground(self, *formulas: Formula) -> tuple[Formula, ...]:
        """Return formulas as they are evaluated, with closed bounds (``rtamt.rewrite.ground``).

        They are returned as they are while the step is unknown.
        """
        if self.step is None:
            return formulas
        return grounds(formulas, self.step, continuous=self.continuous)

    def sampling(self, rule: Sampling | None) -> Sampling | None:
        """Return the sampling rule if it applies: where recordings have a period."""
        return rule if self.sampled else None

    @abstractmethod
    def check_inputs(self, names: Collection[str]) -> None:
        """Raise :class:`UsageError` where these variables do not suffice to evaluate a formula."""

    @abstractmethod
    def record(
        self, data: Any, names: Sequence[str], unit: str | None = None, types: Types = NO_TYPES
    ) -> DomainTrace:
        """Normalise a finished recording of the variables ``names``; the caller's data is never changed.

        ``unit``: of times that are numbers, by default seconds. ``types``: of the variables that are no plain numbers.
        Raises :class:`TraceError`.
        """


class DomainTrace(ABC):
    """A finished recording in one time domain, normalised.

    Positions count steps (samples or ticks) from the first instant at which formulas are evaluated.
    """

    __slots__ = ()

    #: By variable: values, or ticks and values.
    columns: Mapping[str, Any]
    #: The units of the variables whose source gives them.
    units: Mapping[str, str]
    #: By variable: lower and upper bounds of its samples; empty where all are known exactly.
    bounds: Mapping[str, Bounds]
    #: By variable: which of its samples are missing; only of those that lack some.
    missing: Mapping[str, Mask]

    @property
    @abstractmethod
    def domain(self) -> TimeDomain:
        """The time domain, whose step is known."""

    @property
    @abstractmethod
    def step(self) -> Fraction:
        """Seconds of one step."""

    @property
    @abstractmethod
    def start(self) -> int:
        """The first instant at which formulas are evaluated, in samples or ticks."""

    @property
    @abstractmethod
    def end(self) -> int:
        """The last instant at which a variable has a sample, in samples or ticks."""

    @property
    def latest(self) -> int:
        """The last instant at which a variable may change: later than the end where other variables end the recording.

        A window without an end is read until then.
        """
        return self.end

    @property
    def last(self) -> int:
        """The position of the last sample."""
        return self.end - self.start

    @property
    @abstractmethod
    def samples(self) -> int:
        """The number of instants at which a variable has a sample."""

    @property
    @abstractmethod
    def size(self) -> int:
        """The number of samples that one pass over the recording takes."""

    @abstractmethod
    def check(self, formula: Formula, text: str | None = None, *, given: bool = True) -> Formula:
        """Return the formula with closed bounds; raise :class:`BoundError` or :class:`SpecificationError`.

        ``given``: whether the caller or the specification gave the step; if not, errors name where it is from.
        """

    @abstractmethod
    def select(self, names: Iterable[str]) -> Self:
        """Return the recording of these variables alone."""

    @abstractmethod
    def bounded(self, bounds: Mapping[str, Bounds], missing: Mapping[str, Mask]) -> Self:
        """Return the recording with bounds of the samples of each variable, and where they are missing."""

    @abstractmethod
    def with_presence(self, channels: Mapping[str, str]) -> Self:
        """Return the recording with a column for each channel that is 1 where its variable has a sample, else 0.

        ``channels``: from a variable to the name of the channel.
        """

    @abstractmethod
    def with_units(self, units: Mapping[str, str]) -> Self:
        """Return the recording with these units of its variables."""

    @abstractmethod
    def started(self, names: Collection[str]) -> Self:
        """Return the recording for formulas of these variables: it starts when all of them have started."""

    def ended_by(self, names: Collection[str]) -> Self:  # noqa: ARG002 - most domains end so
        """Return the recording that ends with the last sample of these variables, whatever the others have later."""
        return self

    @abstractmethod
    def held_until(self, end: int) -> Self:
        """Return the recording up to a later end, as far as variables have values after their last samples."""

    @abstractmethod
    def in_steps(self) -> Self:
        """Return the recording for signals whose times are counted in steps, where that costs nothing."""

    @abstractmethod
    def positions(self, signal: Signal) -> NDArray[np.int64]:
        """Return the positions of the points of a signal over the recording :meth:`in_steps`."""

    @abstractmethod
    def in_caller_times(self, signal: Signal) -> Signal:
        """Return a signal over the recording :meth:`in_steps` in the caller's times, up to the end."""

    @abstractmethod
    def signals(self, values: Sequence[Any]) -> list[Signal]:
        """Return the result of an evaluation, with the timestamps of the recording."""

    @abstractmethod
    def time(self, position: int) -> Any:
        """Return the time of a position in the caller's format."""

    @abstractmethod
    def times_at(self, positions: NDArray[np.int64]) -> NDArray[Any]:
        """Return the times of positions in the caller's format."""

    @abstractmethod
    def nanoseconds(self, positions: Any) -> NDArray[np.int64]:
        """Return the times of positions in nanoseconds, without a double in between; dates count from 1970.

        Raises :class:`TraceError` for times that 64 bits cannot hold.
        """

    @abstractmethod
    def sampled(self, name: str) -> NDArray[np.int64]:
        """Return the positions of the samples of a variable; those before the first instant are negative."""

    @abstractmethod
    def show(self, position: int) -> str:
        """Return the time of a position for a sentence."""

    @abstractmethod
    def position(self, at: Any) -> int:
        """Return the position of a time in the caller's format; raise :class:`UsageError` outside the trace."""

    def later(self, at: Any) -> int:
        """Return the position of a time at which signals may hold their last values, after the end of the trace."""
        return self.position(at)

    @abstractmethod
    def values(self, name: str) -> FloatArray:
        """Return the values of the samples of a variable."""

    # ---- on an axis ------------------------------------------------------------------------------

    @property
    @abstractmethod
    def origin(self) -> Fraction | np.datetime64:
        """The first instant at which formulas are evaluated: a date, or exact seconds."""

    @abstractmethod
    def seconds(self, times: Any, *, elapsed: bool) -> FloatArray:
        """Convert times in the caller's format to seconds: absolute, or ``elapsed`` since the origin."""

    @abstractmethod
    def ends(self, *, elapsed: bool) -> tuple[float, float]:
        """Return the seconds of the first and the last instant; ``elapsed`` as in :meth:`seconds`."""

    @abstractmethod
    def points(self, name: str, *, elapsed: bool) -> tuple[FloatArray, FloatArray]:
        """Return the seconds and the values of a variable up to the end of the recording."""
