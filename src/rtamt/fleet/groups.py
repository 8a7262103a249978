"""Requirements that read a recording in the same way, in common programs."""

from __future__ import annotations

from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any

from rtamt.engine import Query, Watched, engine_of
from rtamt.errors import StlError
from rtamt.language.formula import Apply, Const
from rtamt.language.operators import STL
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.assumed_period import require_times_of_each
from rtamt.signals.binding import Binding, union
from rtamt.signals.sampling import sampled
from rtamt.verdicts.preparation import is_storable, prepare
from rtamt.verdicts.prepared import Asked, Found, Prepared

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine import OnlineMonitor
    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.language.value_types import ValueType
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain
    from rtamt.specification import Specification


class Asking(NamedTuple):
    """A specification and its query, which may exclude robustness or truth."""

    spec: Specification
    query: Query
    robustness: bool = True
    truth: bool = False

    def why_apart(self) -> str:
        """Return why no common program can hold it, as the end of a sentence; empty if one can."""
        if self.spec.groups:
            return f"quantifies over the members of '{next(iter(self.spec.groups))}', which each recording decides"
        if not engine_of(self.spec.domain).backends[self.spec.backend].compiled:
            return f"is evaluated by backend='{self.spec.backend}'"
        return ""


@dataclass(frozen=True)
class Way:
    """The reading settings of recordings for some requirements.

    ``types``: of the variables that are no plain numbers. ``rule``: by which signals are sampled. ``ending``: the
    variables that end the recording; all if empty.
    """

    domain: TimeDomain
    unit: str | None
    binding: Binding
    types: Mapping[str, ValueType]
    rule: Sampling | None = None
    ending: tuple[str, ...] = ()

    @property
    def inputs(self) -> tuple[str, ...]:
        """The variables."""
        return self.binding.names

    def recording(self, data: Any, read: Sequence[Sequence[str]] = ()) -> DomainTrace:
        """Normalise a recording; raise :class:`TraceError` for wrong data.

        ``read``: the variables of each requirement.
        """
        data = self.binding.applied(data)
        if self.rule is not None:
            period = self.domain.period or self.rule.period
            data = sampled(data, self.inputs, self.rule, period, self.unit)
        trace = self._query.record(data, self.inputs, self.types)
        if self.domain.sampled and self.domain.period is None:
            require_times_of_each(data, read)
        return trace.ended_by(self.ending) if self.ending else trace

    @cached_property
    def _query(self) -> Query:
        return Query(Const(0.0), "", self.domain, "standard", self.unit, engine_of(self.domain))

    def over(self, names: Iterable[str]) -> Way:
        """Return the same for these variables alone."""
        kept = frozenset(names)
        binding = self.binding
        return replace(
            self,
            binding=Binding(
                tuple(name for name in binding.names if name in kept),
                tuple(pair for pair in binding.columns if pair[0] in kept),
                tuple(pair for pair in binding.units if pair[0] in kept),
                tuple(other for other in binding.others if other[0] in kept),
            ),
            types={name: type_ for name, type_ in self.types.items() if name in kept},
        )


@dataclass(frozen=True)
class Programs:
    """The programs of some requirements for one length of a step; ``numbers``: those of each program."""

    parts: tuple[tuple[tuple[int, ...], Prepared], ...]

    def evaluate(self, trace: DomainTrace) -> Iterator[tuple[int, Found]]:
        """Yield the number of each requirement and what is found of it."""
        for numbers, prepared in self.parts:
            yield from zip(numbers, prepared.evaluate(trace), strict=True)

    def signals(self, trace: DomainTrace) -> Iterator[tuple[int, Signal]]:
        """Yield the number of each requirement and its robustness signal."""
        for numbers, prepared in self.parts:
            yield from zip(numbers, prepared.signals(trace), strict=True)

    def only(self, kept: Iterable[int]) -> Programs:
        """Return the programs of some of the requirements."""
        asked = frozenset(kept)
        parts = []
        for numbers, prepared in self.parts:
            places = [place for place, number in enumerate(numbers) if number in asked]
            if places:
                part = prepared if len(places) == len(numbers) else prepared.part(places)
                parts.append((tuple(numbers[place] for place in places), part))
        return Programs(tuple(parts))


class Group:
    """Requirements that share a way to read recordings.

    ``inputs``: by number of a requirement its variables. ``asked``: by number what is asked, where formulas are known.
    ``programs``: those for the step of the time domain, where they are known.
    """

    def __init__(
        self,
        way: Way,
        inputs: Mapping[int, tuple[str, ...]],
        asked: Mapping[int, Asking] | None,
        programs: Programs | None = None,
    ) -> None:
        self.way = way
        self.inputs = inputs
        self.asked = asked or {}
        self._programs: dict[Fraction, Programs] = {}
        if programs is not None:
            assert way.domain.step is not None
            self._programs[way.domain.step] = programs
        self._subgroups: dict[tuple[int, ...], Group] = {}

    def programs(self, step: Fraction) -> Programs:
        """Return the programs for a length of a step."""
        found = self._programs.get(step)
        if found is None:
            domain = (
                self.way.domain if self.way.domain.step is not None else _with_step(self.way.domain, step)
            )
            parts = []
            numbers = tuple(self.inputs)
            outputs = {number: _outputs(self.asked[number]) for number in numbers}
            first = 0
            for prepared in prepare([outputs[number] for number in numbers], self.way.inputs, domain):
                parts.append((numbers[first : first + len(prepared)], prepared))
                first += len(prepared)
            found = self._programs[step] = Programs(tuple(parts))
        return found

    def recording(self, data: Any) -> DomainTrace:
        """Normalise a recording; raise :class:`TraceError` for wrong data."""
        return self.way.recording(data, self._read)

    @cached_property
    def _read(self) -> Sequence[Sequence[str]]:
        """The variables of each requirement, also of several in one specification."""
        specs = (asking.spec for asking in self.asked.values())
        found = [one.input_names for spec in specs for one in spec.requirements.values()]
        return found or [*self.inputs.values()]

    def evaluate(self, data: Any) -> Iterator[tuple[int, Found | StlError, DomainTrace | None]]:
        """Yield for each requirement what is found of it, or why it cannot be evaluated, and its recording."""
        try:
            trace = self.recording(data)
        except StlError as error:
            if len(self.inputs) == 1:
                yield next(iter(self.inputs)), error, None
                return
            for number in self.inputs:  # each may lack, or need, something else
                yield from self.of([number]).evaluate(data)
            return
        wrong: dict[int, StlError] = {}
        for number, asking in self.asked.items():
            why = _misfit(asking, trace)
            if why is not None:
                wrong[number] = why
        for number, why in wrong.items():
            yield number, why, trace
        kept = [number for number in self.inputs if number not in wrong]
        if kept:
            group = self.of(kept) if wrong else self
            for number, found in group.programs(trace.step).evaluate(trace):
                yield (
                    number,
                    found if found.error is None or found.robustness is not None else found.error,
                    trace,
                )

    def monitor(self, names: Sequence[str]) -> OnlineMonitor:
        """Return a monitor of the conjunction of all requirements, which watches each by its name."""
        watched = []
        for name, asking in zip(names, self.asked.values(), strict=True):
            formula = next(each for each in _outputs(asking) if each is not None)
            watched.append(Watched(name, formula, asking.spec.text))
        whole = reduce(lambda a, b: Apply(STL["and"], (a, b)), (each.formula for each in watched))
        domain = self.way.domain.online
        declared = {name for asking in self.asked.values() for name in asking.spec._declared}
        monitor: OnlineMonitor = engine_of(domain).monitor(
            whole, domain, unit=self.way.unit, declared=declared, watch=watched
        )
        monitor.bind(self.way.binding)
        return monitor

    def of(self, numbers: Sequence[int]) -> Group:
        """Return the group of some of the requirements."""
        key = tuple(numbers)
        if len(key) == len(self.inputs):
            return self
        found = self._subgroups.get(key)
        if found is None:
            inputs = {number: self.inputs[number] for number in key}
            asked = {number: self.asked[number] for number in key if self.asked}
            way = self.way.over(name for names in inputs.values() for name in names)
            found = Group(way, inputs, asked)
            found._programs = {step: programs.only(key) for step, programs in self._programs.items()}
            self._subgroups[key] = found
        return found


def _misfit(asking: Asking, trace: DomainTrace) -> StlError | None:
    """Return the error if a bound does not fit the step of a recording."""
    try:
        asking.spec._check(asking.query, trace)
    except StlError as error:
        return error
    return None


def _with_step(domain: TimeDomain, step: Fraction) -> TimeDomain:
    return type(domain).of(step, domain.tolerance, domain.resolution)


def _outputs(asking: Asking) -> Asked:
    spec, semantics = asking.spec, asking.query.semantics
    return Asked(
        spec._apply_semantics(spec.formula, semantics) if asking.robustness else None,
        spec._outputs(semantics).truth if asking.truth else None,
    )


def way_of(spec: Specification) -> Way:
    """Return the reading settings of recordings for one specification."""
    rule = spec.domain.sampling(spec.sampling)
    return Way(spec.domain, None, spec.binding, spec.types, rule if rule is not None and rule.hold else None)


def grouped(asked: Mapping[int, Asking]) -> tuple[list[Group], dict[int, str]]:
    """Return groups of requirements by number, and why each of the others has to be evaluated by itself."""
    apart: dict[int, str] = {}
    alike: dict[Any, list[_Fitting]] = {}
    for number, asking in asked.items():
        why = asking.why_apart() or is_storable(_outputs(asking))
        if why:
            apart[number] = why
            continue
        spec, domain = asking.spec, asking.query.domain
        rule = domain.sampling(spec.sampling)
        rule = rule if rule is not None and rule.hold else None
        ending = () if spec.resolved is None else spec.resolved[0].input_names
        # Its variables determine the samples, or the extent, of such a recording.
        own = frozenset(spec.input_names) if rule is not None or domain.own_time_bases else None
        fits = alike.setdefault((domain, asking.query.unit, rule, ending, own), [])
        places: dict[str, Any] = {
            name: (place, spec.types.get(name)) for name, place in spec.binding.places().items()
        }
        fitting = next((one for one in fits if one.takes(places)), None)
        if fitting is None:
            fitting = _Fitting({}, {}, Way(domain, asking.query.unit, Binding(()), {}, rule, ending))
            fits.append(fitting)
        fitting.asked[number] = asking
        fitting.places.update(places)
    return [one.group() for fits in alike.values() for one in fits], apart


@dataclass
class _Fitting:
    """Requirements that agree about the recorded name, the unit and the type of every variable."""

    asked: dict[int, Asking]
    places: dict[str, Any]
    way: Way

    def takes(self, places: Mapping[str, Any]) -> bool:
        return all(self.places.get(name, place) == place for name, place in places.items())

    def group(self) -> Group:
        specs = [asking.spec for asking in self.asked.values()]
        types = {name: type_ for spec in specs for name, type_ in spec.types.items()}
        way = replace(self.way, binding=union([spec.binding for spec in specs]), types=types)
        return Group(way, {number: each.spec.input_names for number, each in self.asked.items()}, self.asked)
