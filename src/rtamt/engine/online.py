"""The base of the monitors of both time domains: watched formulas, and copies."""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction

from rtamt.errors import UsageError, changed_state, did_you_mean
from rtamt.language.contents import types_of, variables
from rtamt.language.formula import Formula
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar, TypeVar
from rtamt.rewrite.check import check_online
from rtamt.rewrite.horizon import horizon
from rtamt.signals import arrays
from rtamt.signals.binding import Binding
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from rtamt.engine.backend import Session
    from rtamt.signals.episodes import Episode, EpisodeTracker
    from rtamt.signals.time_domain_interface import TimeDomain

    Self = TypeVar("Self", bound="OnlineMonitor")


@dataclass(frozen=True, slots=True)
class Watched:
    """A formula whose values are kept in addition to the result; ``text`` is the text of its spans.

    ``name``: what the caller gave, by which :meth:`OnlineMonitor.__getitem__` finds it again.
    """

    name: str | Formula
    formula: Formula
    text: str | None


def grounded(
    domain: TimeDomain, formula: Formula, text: str | None, watch: Sequence[Watched]
) -> tuple[Formula, list[Watched]]:
    """Return a formula and the watched formulas as they are evaluated; raise errors of the time domain."""
    changed = domain.check(formula, text) is not formula
    for watched in watch:
        changed |= domain.check(watched.formula, watched.text) is not watched.formula
    if not changed:
        return formula, [*watch]
    formula, *others = domain.ground(formula, *(watched.formula for watched in watch))
    return formula, [replace(each, formula=other) for each, other in zip(watch, others, strict=True)]


def _label(name: str | Formula) -> str:
    from rtamt.language.printing.printer import excerpt

    return excerpt(name) if isinstance(name, Formula) else str(name)


class OnlineMonitor:
    """A monitor of either time domain; a mixin of classes of the compiled core. Not instantiated by users."""

    #: The attributes that form the state of a monitor, apart from that of its back end.
    _remembered: ClassVar[tuple[str, ...]]

    #: What takes a sample, and has to be initialised.
    _base: ClassVar[type]

    _backend: Any
    _session: Session

    def __init__(
        self,
        formula: Formula,
        watch: Sequence[Watched],
        declared: Collection[str],
        factory: Callable[..., OnlineMonitor] | None,
    ) -> None:
        self._base.__init__(self)  # type: ignore[misc] # the class of the core that it derives from
        self.input_names: tuple[str, ...] = variables(formula)
        for watched in watch:
            for name in variables(watched.formula):
                if name not in self.input_names:
                    raise UsageError(
                        f"'{_label(watched.name)}' reads '{name}', which the formula does not"
                        f"{did_you_mean(name, self.input_names)}; watch what reads "
                        f"{', '.join(self.input_names) or 'no variable'} only"
                    )
        self._formulas = (formula, *(watched.formula for watched in watch))
        self._types = types_of(formula)
        self._output_of = {watched.name: output for output, watched in enumerate(watch, 1)}
        self._declared = declared
        self._binding = Binding(self.input_names)
        self._factory = factory
        self._usage = UsageGuard()  # serialises operations of several steps
        self._finished = False
        #: The collectors of episodes of each formula; None if episodes are not recorded.
        self._episodes: list[EpisodeTracker] | None = None

    def bind(self, binding: Binding) -> None:
        """Find variables in chunks of recordings as a specification does."""
        self._binding = binding

    def _remember_episodes(self, *, continuous: bool) -> None:
        from rtamt.signals.episodes import EpisodeTracker

        self._episodes = [EpisodeTracker(continuous=continuous) for _ in self._formulas]

    def episodes(self, name: str | Formula | None = None) -> list[Episode]:
        """Return the maximal runs of violation so far, with begin, end, and the worst robustness and its instant.

        ``name``: of a formula that is watched, such as one of several requirements. The last episode may continue.
        For monitors made with ``episodes=True``; they remember all episodes, and take each sample a little slower.

        >>> import rtamt
        >>> monitor = rtamt.parse("x >= 3").monitor(episodes=True)
        >>> for t, x in enumerate([5, 2, 1, 3, 0]):
        ...     _ = monitor.update(t, x=x)
        >>> monitor.episodes()[0]
        Episode(begin=1.0, end=2.0, worst=-2.0, at=2.0)
        """
        if self._episodes is None:
            raise UsageError("the monitor does not remember episodes; make it with monitor(episodes=True)")
        return self._episodes[0 if name is None else self._output(name)].episodes()

    @property
    @abstractmethod
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""

    @property
    def memory(self) -> int:
        """The size of the state in bytes: the contents of the windows."""
        return int(self._backend.state_bytes)

    @property
    def _unread(self) -> frozenset[str]:
        """Declared variables that the formula does not read; an update may contain them."""
        return frozenset(self._declared) - {
            head for name in self.input_names for head in (name, name.split(".")[0])
        }

    def _output(self, name: str | Formula) -> int:
        output = self._output_of.get(name)
        if output is None:
            labels = [_label(watched) for watched in self._output_of]
            watches = ", ".join(f"'{label}'" for label in labels)
            label = _label(name)
            raise UsageError(
                f"'{label}' is not watched{did_you_mean(label, labels)}; "
                + (f"the monitor watches {watches}" if watches else "name it in monitor(watch=...)")
            )
        return output

    def _read_by_formula(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values that the formula reads: fields of objects, without unread variables."""
        heads = {name.split(".")[0] for name in self.input_names}
        flat = {
            name: value
            for name, value in values.items()
            if name in self.input_names or (name not in heads and name not in self._declared)
        }
        for name in self.input_names:
            head, *path = name.split(".")
            if path and name not in values and head in values:
                flat[name] = arrays.field_of(values[head], head, path, self.samples)
        return flat

    def _assign(self, parameters: Mapping[str, Any]) -> None:
        """Become a new monitor with these values of parameters."""
        if not parameters:
            return
        if self._factory is None:
            raise UsageError("only a monitor that Specification.monitor() has made has parameters")
        fresh = self._factory(parameters)
        usage = self._usage
        self.__dict__.update(fresh.__dict__)
        self._usage = usage
        self._connect(self._session.open())

    # ---- many keys ---------------------------------------------------------------------------------

    def records(
        self,
        capacity: int,  # noqa: ARG002 - DiscreteFleet takes these
        *,
        restart: bool,  # noqa: ARG002 - as above
        state: bytes | None,  # noqa: ARG002 - as above
        identities: Mapping[str, str],  # noqa: ARG002 - as above
        watched: bool = False,  # noqa: ARG002 - as above
    ) -> Any:
        """Return a monitor of these formulas for many keys at once; None if each key needs its own monitor.

        See :class:`rtamt.engine.discrete.fleet.DiscreteFleet`.
        """
        return None

    # ---- copies ----------------------------------------------------------------------------------

    @abstractmethod
    def _connect(self, backend: Any) -> None:
        """Continue with this back end."""

    def __copy__(self: Self) -> Self:
        twin = type(self).__new__(type(self))
        twin._base.__init__(twin)  # type: ignore[misc] # as in __init__
        twin.__dict__.update(self.__dict__)  # nothing in it is changed in place
        twin._usage = UsageGuard()
        twin._resume(self._state())
        return twin

    def __deepcopy__(self: Self, memo: dict[int, Any]) -> Self:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        if self._factory is None:
            raise UsageError("only a monitor that Specification.monitor() has made can be pickled")
        return _rebuild, (self._factory, self._state())

    @exclusive
    def _state(self) -> tuple[Any, ...]:
        self._session.require_copyable()
        remembered = {name: getattr(self, name) for name in self._remembered}
        return self._session.fingerprint, remembered, self._backend.state()

    def _resume(self, state: tuple[Any, ...]) -> None:
        fingerprint, remembered, of_backend = state
        if fingerprint != self._session.fingerprint:
            raise UsageError(
                "the monitor was pickled by a version of rtamt that compiles its formula to another program; "
                "make a new monitor"
            )
        self.__dict__.update(remembered)
        backend = self._session.open()
        try:
            backend.restore(of_backend)
        except ValueError:
            raise changed_state() from None
        self._connect(backend)
        if self._episodes is not None:
            self._episodes = [tracker.copied() for tracker in self._episodes]


def depth_of(formula: Formula, period: Fraction = Fraction(1), text: str | None = None) -> Fraction:
    """Return the horizon of a formula in seconds; raise :class:`BoundError` for unbounded future, see ``text``."""
    depth = horizon(formula, period)
    if depth is None:
        check_online(formula, text)
    assert depth is not None, "unbounded future is rejected"
    return depth


def _rebuild(factory: Callable[[], OnlineMonitor], state: tuple[Any, ...]) -> OnlineMonitor:
    monitor = factory()
    monitor._factory = factory
    monitor._resume(state)
    return monitor
