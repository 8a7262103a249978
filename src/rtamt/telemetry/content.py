"""The exported content of a result: signals and findings over time, in nanoseconds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.language.distinct import distinct
from rtamt.language.value_types import value_names
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.plot.band import band
from rtamt.rewrite.presence import channel_of
from rtamt.signals.epoch import is_epoch
from rtamt.signals.outcomes import BoundedSignal
from rtamt.violations import episodes_in_steps, first_violation

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from rtamt.results import Result
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.episodes import Episode
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace

    Nanoseconds = NDArray[np.int64]

VERDICTS = SATISFIED, VIOLATED, UNKNOWN = "satisfied", "violated", "unknown"
#: Characters of a name that a key keeps; metrics of MLflow may have 250 in all.
_LONGEST = 150
_OTHER = lazy_pattern(r"[^A-Za-z0-9_-]+")


@dataclass(frozen=True, slots=True, eq=False)
class Bounded:
    """Numbers over time, each between ``lower`` and ``upper``; both are equal where the number is known."""

    times: Nanoseconds
    lower: FloatArray
    upper: FloatArray

    @property
    def known(self) -> tuple[Nanoseconds, FloatArray]:
        """The times at which the number is known, and the numbers."""
        exact = self.lower == self.upper
        return self.times[exact], self.lower[exact]


@dataclass(frozen=True, slots=True, eq=False)
class Variable:
    """The samples of a variable; ``key``: its name in topics; ``names``: of values (enumerations)."""

    name: str
    key: str
    samples: Bounded
    unit: str
    names: Mapping[float, str]


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The result of a requirement, over time and at the start.

    ``verdicts``: the verdict at the first instant, at each at which it changes, and at the last one. ``known``: bounds
    of the robustness at the start, after each sample; None if they were not asked for. ``satisfied``: None if the
    samples do not decide it.
    """

    name: str
    key: str
    formula: str
    variables: tuple[str, ...]  # their keys
    robustness: Bounded
    verdicts: tuple[tuple[int, str], ...]
    known: Bounded | None
    satisfied: bool | None
    first_violation: int | None
    episodes: tuple[Episode, ...]

    @property
    def start(self) -> int:
        """The first instant."""
        return int(self.robustness.times[0])

    @property
    def verdict(self) -> str:
        """The verdict at the first instant."""
        return UNKNOWN if self.satisfied is None else SATISFIED if self.satisfied else VIOLATED


@dataclass(frozen=True, slots=True, eq=False)
class Content:
    """The exported content of a result; ``dated``: whether times count from 1970."""

    variables: tuple[Variable, ...]
    findings: tuple[Finding, ...]
    dated: bool

    @property
    def start(self) -> int:
        """The first instant at which a requirement is evaluated."""
        return min(finding.start for finding in self.findings)


def results_by_name(result: Result | Mapping[str, Result]) -> dict[str, Result]:
    """Return the result of each requirement."""
    if not isinstance(result, Mapping):
        return dict(result.requirements)
    if not result:
        raise UsageError("there are no results; give those of one requirement or more")
    found: dict[str, Result] = {}
    for name, part in result.items():
        several = part.requirements
        found |= (
            {name: part} if len(several) == 1 else {f"{name}: {key}": one for key, one in several.items()}
        )
    return found


def content_of(result: Result | Mapping[str, Result], *, bounds: bool = False) -> Content:
    """Return the exported content of a result, or of results by the names of their requirements.

    ``bounds``: also the bounds of the robustness at the start, as known after each sample.
    """
    parts = results_by_name(result)
    owners: dict[str, Result] = {}
    for part in parts.values():
        for name in part.specification.input_names:
            if name in part.trace.columns:
                owners.setdefault(name, part)
    variable_keys = _keys(owners)
    variables = tuple(_variable(name, variable_keys[name], owner) for name, owner in owners.items())
    keys = _keys(parts)
    findings = tuple(_finding(name, keys[name], part, variable_keys, bounds) for name, part in parts.items())
    origins = [part.trace.origin for part in parts.values()]
    dated = all(isinstance(origin, np.datetime64) or is_epoch(origin) for origin in origins)
    return Content(variables, findings, dated)


def _keys(names: Iterable[str]) -> dict[str, str]:
    """Return a part of a topic for each name: letters, digits, ``_`` and ``-``, each once.

    >>> _keys(["gap", "/odom.x", "/odom/x"])
    {'gap': 'gap', '/odom.x': 'odom_x', '/odom/x': 'odom_x_2'}
    """
    return distinct(names, lambda name: _OTHER.sub("_", name).strip("_")[:_LONGEST] or "unnamed")


def _variable(name: str, key: str, result: Result) -> Variable:
    trace = result.trace
    values = np.asarray(trace.values(name), np.float64)
    times = trace.nanoseconds(trace.sampled(name))
    lower, upper = (np.asarray(ends, np.float64) for ends in trace.bounds.get(name, (values, values)))
    present = _present(name, trace)
    samples = Bounded(times[present], lower[present], upper[present])
    names = value_names(result.specification.types.get(name))
    return Variable(name, key, samples, trace.units.get(name, ""), names)


def _present(name: str, trace: DomainTrace) -> NDArray[np.bool_]:
    """Return which samples of a variable were recorded: not those where it, or its member of a group, is absent."""
    places = trace.sampled(name)
    missing = trace.missing.get(name)
    present: NDArray[np.bool_] = np.ones(len(places), bool) if missing is None else ~missing
    parts = name.split(".")
    for end in range(1, len(parts)):
        channel = channel_of(".".join(parts[:end]))
        if channel in trace.columns:
            last = trace.sampled(channel).searchsorted(places, "right") - 1
            present = present & (last >= 0) & (trace.values(channel)[last] > 0)
    return present


def _finding(name: str, key: str, result: Result, variable_keys: Mapping[str, str], bounds: bool) -> Finding:
    if bounds and result.trace.bounds:
        raise UsageError(
            f"bounds over time of '{name}' need samples that are known exactly; leave out bounds: the robustness of "
            f"missing or uncertain samples has bounds at each instant"
        )
    trace, spec = result.trace, result.specification
    robustness, truth = spec._signals_of(spec._outputs(result.semantics), trace.in_steps())
    verdicts = tuple(_changes(_bounded_steps(truth, result)))
    violated = None if trace.bounds else first_violation(result)
    return Finding(
        name,
        key,
        str(spec.formula),
        tuple(variable_keys[each] for each in spec.input_names if each in trace.columns),
        _bounded_steps(robustness, result),
        verdicts,
        _known(result) if bounds else None,
        {SATISFIED: True, VIOLATED: False}.get(verdicts[0][1]) if trace.bounds else result.satisfied,
        None if violated is None else _nanoseconds(result, trace.later(violated)),
        tuple(
            episode.with_times(lambda position: _nanoseconds(result, position))
            for episode in episodes_in_steps(result, certain=True)
        ),
    )


def _nanoseconds(result: Result, position: int) -> int:
    return int(result.trace.nanoseconds([position])[0])


def _bounded_steps(signal: Signal, result: Result) -> Bounded:
    """Return a signal over the trace in steps."""
    lower, upper = (
        (signal.lower, signal.upper) if isinstance(signal, BoundedSignal) else (signal.values, signal.values)
    )
    # No minus before a zero.
    return Bounded(result.trace.nanoseconds(result.trace.positions(signal)), lower + 0.0, upper + 0.0)


def _changes(truth: Bounded) -> Iterator[tuple[int, str]]:
    """Yield the first verdict, every other than the one before, and the last, to which viewers draw the one before."""
    codes = np.where(truth.lower > 0, 1, np.where(truth.upper < 0, -1, 0))
    shown = np.concatenate(([True], codes[1:] != codes[:-1]))
    shown[-1] = True
    places = np.flatnonzero(shown)
    texts = {1: SATISFIED, -1: VIOLATED, 0: UNKNOWN}
    for place in places.tolist():
        yield int(truth.times[place]), texts[int(codes[place])]


def _known(result: Result) -> Bounded:
    found = band(result)
    return Bounded(result.trace.nanoseconds(found.steps), found.lower + 0.0, found.upper + 0.0)
