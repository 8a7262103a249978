"""Several requirements in one dense-time monitor: each trace starts with the variables of its requirement.

Requirements that read the same variables form a part: one program, with a trace that starts when all of its
variables have started. The first output of the back end is the minimum of all requirements: it starts with the
first of them, and at each instant it is the minimum over those that have started. It is known as far as all
requirements are.
"""

from __future__ import annotations

from copy import copy

from rtamt.engine.backend import RefusedError, Session
from rtamt.engine.online import depth_of
from rtamt.errors import UsageError
from rtamt.language.contents import own_variables
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias
from rtamt.rewrite.check import always_has_a_value
from rtamt.signals.dense_arrays import changes, minimum
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from rtamt.compiler.program import CallSite
    from rtamt.engine.backend import Backend
    from rtamt.language.formula import Formula
    from rtamt.signals.dense import Dense
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TimeScale

#: A place among the outputs of the parts: the number of the part, and that of its output.
Place: TypeAlias = tuple[int, int]


def _nothing() -> Samples:
    return np.empty(0, np.int64), np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Formulas over one trace, and the session that monitors them."""

    names: tuple[str, ...]
    formulas: tuple[Formula, ...]
    session: Session
    can_fail: bool

    @property
    def calls(self) -> bool:
        """Whether a custom operator has state that cannot be saved."""
        return bool(self.session.calls)


def parts_of(
    requirements: Sequence[Formula],
    watched: Sequence[Formula],
    every: Sequence[str],
    domain: Dense,
    backend: Backend,
) -> tuple[list[Part], list[Place]]:
    """Return the parts, and where the requirements and then the watched formulas are.

    The trace of a watched formula that is not a requirement has all variables. Parts that can fail come first.
    """
    formulas: dict[frozenset[str], list[Formula]] = {}
    keys = [frozenset(own_variables(formula, every)) for formula in requirements]
    own = dict(zip(requirements, keys, strict=True))
    keys += [own.get(formula, frozenset(every)) for formula in watched]
    asked = [*requirements, *watched]
    for key, formula in zip(keys, asked, strict=True):
        known = formulas.setdefault(key, [])
        if formula not in known:
            known.append(formula)
    parts = {}
    for key, some in formulas.items():
        names = tuple(name for name in every if name in key)
        session = backend.session(some, names, domain)
        parts[key] = Part(names, tuple(some), session, not all(map(always_has_a_value, some)))
    if sum(part.calls for part in parts.values()) > 1:
        raise UsageError(
            "custom operators stand in requirements that read different variables, so that a failed update could not "
            "be undone; monitor each requirement alone, or use backend='python'"
        )
    order = sorted(parts, key=lambda key: (not parts[key].can_fail, parts[key].calls))
    places = [(order.index(key), formulas[key].index(f)) for key, f in zip(keys, asked, strict=True)]
    return [parts[key] for key in order], places


class UndefinedInPartError(Exception):
    """An operation of a part is undefined; the cause is the error of its program."""

    def __init__(self, part: Part, error: Exception) -> None:
        super().__init__(*error.args)
        self.part = part
        self.error = error


class GroupSession(Session):
    """Requirements with different variables, and the watched formulas."""

    def __init__(
        self,
        requirements: Sequence[Formula],
        watched: Sequence[Formula],
        every: Sequence[str],
        domain: Dense,
        backend: Backend,
    ) -> None:
        self._parts, self._places = parts_of(requirements, watched, every, domain, backend)
        self._made_of = len(requirements), tuple(every), domain.resolution
        self.undefined = (UndefinedInPartError,)

    def open(self) -> DenseGroups:
        """See :class:`Session`."""
        return DenseGroups(self._parts, self._places, *self._made_of)

    def culprit(self, error: Any) -> Formula:
        """See :class:`Session`."""
        formula: Formula = error.part.session.culprit(error.error)
        return formula

    @property
    def fingerprint(self) -> bytes:
        """See :class:`Session`."""
        return b"".join(part.session.fingerprint for part in self._parts)

    @property
    def calls(self) -> Sequence[CallSite]:
        """See :class:`Session`."""
        return [site for part in self._parts for site in part.session.calls]


class DenseGroups:
    """The back end; see ``_core.DenseMonitor`` for what each method means."""

    _REMEMBERED = ("_counts", "_last", "_values", "_pending", "_until", "_minimum", "_results")

    def __init__(
        self,
        parts: Sequence[Part],
        places: Sequence[Place],
        requirements: int,
        names: Sequence[str],
        tick: Fraction,
    ) -> None:
        self._parts = tuple(parts)
        self._requirements, self._watched = places[:requirements], places[requirements:]
        self._names = tuple(names)
        self._lags = [int(depth_of(parts[part].formulas[i]) / tick) for part, i in self._requirements]
        self._usage = UsageGuard()
        self._start_over()

    def _start_over(self) -> None:
        self._backends = [part.session.open() for part in self._parts]
        self._counts = dict.fromkeys(self._names, 0)
        self._last: dict[str, tuple[int, float]] = {}
        self._values = [float("inf")] * len(self._requirements)  # so far, as far as the minimum is known
        self._pending = [_nothing()] * len(self._requirements)  # known beyond that
        self._until: int | None = None
        self._minimum = float("nan")  # the last value reported
        self._results: list[Samples] = [_nothing()] * (1 + len(self._watched))

    # ---- samples ---------------------------------------------------------------------------------

    def update(self, *_: Any) -> Any:
        """Refuse: there is no fast path."""
        raise RefusedError("time")

    def set_time_scale(self, signal: type, scale: TimeScale, rate: float, whole: bool = False) -> None:
        """Ignore the time scale: every update takes the slow path."""

    @exclusive
    def push(self, columns: Sequence[Samples]) -> Samples:
        """Take a chunk, checked by the caller; return what became known of the minimum."""
        given = dict(zip(self._names, columns, strict=True))

        def push_part(part: Part, backend: Any) -> list[Samples]:
            return _outputs(part, backend, backend.push([given[name] for name in part.names]))

        news = self._run(push_part)
        for name, (ticks, values) in given.items():
            if len(ticks):
                self._last[name] = int(ticks[-1]), float(values[-1])
                self._counts[name] += len(ticks)
        if len(self._last) < len(self._names):
            return self._known(news, None)
        until = (
            min(self._last[name][0] for name in self._parts[part].names) - lag
            for (part, _), lag in zip(self._requirements, self._lags, strict=True)
        )
        return self._known(news, min(until))

    @exclusive
    def finish(self) -> Samples:
        """End the trace; every requirement is known up to the last sample of any variable."""
        end = max(tick for tick, _ in self._last.values())

        def finish_part(part: Part, backend: Any) -> list[Samples]:
            last = [self._last[name] for name in part.names]
            held = [(np.array([end]), np.array([v])) if tick < end else _nothing() for tick, v in last]
            before = _outputs(part, backend, backend.push(held))
            rest = _outputs(part, backend, backend.finish())
            return [changes(*_join(*both)) for both in zip(before, rest, strict=True)]

        return self._known(self._run(finish_part, twice=True), end)

    def _run(self, step: Callable[[Part, Any], list[Samples]], *, twice: bool = False) -> list[list[Samples]]:
        """Run every part and return its outputs; where one fails, none has moved.

        ``twice``: whether a step moves a part more than once.
        """
        saved: dict[int, Any] = {}
        news = []
        undefined = self._parts[0].session.undefined
        for i, (part, backend) in enumerate(zip(self._parts, self._backends, strict=True)):
            later = i + 1 < len(self._parts) and self._parts[i + 1].can_fail
            if part.can_fail and not part.calls and (later or twice):
                saved[i] = backend.state()
            try:
                news.append(step(part, backend))
            except Exception as error:
                for number, state in saved.items():
                    self._backends[number] = self._parts[number].session.open()
                    self._backends[number].restore(state)
                if isinstance(error, undefined):
                    raise UndefinedInPartError(part, error) from error
                raise
        return news

    def _known(self, news: Sequence[Sequence[Samples]], until: int | None) -> Samples:
        """Take what became known of every output; return the minimum up to ``until``, as far as that is new."""
        self._results = [_nothing(), *(news[part][i] for part, i in self._watched)]
        for number, (part, i) in enumerate(self._requirements):
            self._pending[number] = _join(self._pending[number], news[part][i])
        if until is None or (self._until is not None and until <= self._until):
            return self._results[0]
        due = []
        for number, (ticks, values) in enumerate(self._pending):
            split = int(ticks.searchsorted(until, "right"))
            due.append((ticks[:split], values[:split]))
            self._pending[number] = ticks[split:], values[split:]
        ticks, values = minimum(due, self._values)
        self._values = [
            float(own[-1]) if len(own) else before for (_, own), before in zip(due, self._values, strict=True)
        ]
        if self._until is None and not len(ticks):  # before all requirements
            return self._results[0]
        self._until = until
        if not len(ticks) or ticks[-1] < until:
            ticks, values = _join((ticks, values), (np.array([until]), np.array([min(self._values)])))
        self._results[0] = changes(ticks, values, self._minimum)
        self._minimum = float(values[-1])
        return self._results[0]

    # ---- knowledge -------------------------------------------------------------------------------

    @property
    def counts(self) -> list[int]:
        """The number of samples of each input."""
        return [self._counts[name] for name in self._names]

    @property
    def last_times(self) -> list[int | None]:
        """The tick of the last sample of each input, or None."""
        return [self._last[name][0] if name in self._last else None for name in self._names]

    @property
    def state_bytes(self) -> int:
        """Bytes of state of all parts."""
        return sum(int(backend.state_bytes) for backend in self._backends)

    def last_output(self, output: int) -> Samples:
        """Return the new values of an output after the last update."""
        return self._results[output]

    def points(self) -> list[list[tuple[int, float]]]:
        """The same of every output: a list for each, of pairs of tick and value."""
        return [list(zip(ticks.tolist(), values.tolist(), strict=True)) for ticks, values in self._results]

    @exclusive
    def reset(self) -> None:
        """Forget the trace."""
        self._start_over()

    @exclusive
    def state(self) -> tuple[Any, ...]:
        """Return the state after the samples so far."""
        mine = {name: copy(getattr(self, name)) for name in self._REMEMBERED}
        return [backend.state() for backend in self._backends], mine

    def restore(self, state: tuple[Any, ...]) -> None:
        """Restore the state of a back end of the same parts."""
        of_parts, mine = state
        for backend, own in zip(self._backends, of_parts, strict=True):
            backend.restore(own)
        for name, value in mine.items():
            setattr(self, name, copy(value))


def _outputs(part: Part, backend: Any, first: Samples) -> list[Samples]:
    """Return the new values of every output of a part; ``first``: of the first one."""
    return [first, *(backend.last_output(i) for i in range(1, len(part.formulas)))]


def _join(before: Samples, after: Samples) -> Samples:
    return np.concatenate((before[0], after[0])), np.concatenate((before[1], after[1]))
