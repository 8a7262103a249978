"""``Suite``: many requirements compiled once into few programs."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError, choices, placed, shown
from rtamt.fleet.groups import Asking, Way, grouped, way_of
from rtamt.fleet.suite_requirements import SuiteRequirement, named_requirements
from rtamt.fleet.suite_snapshot import packed, unpacked
from rtamt.fleet.verdict_table import SELECTABLE, Row, VerdictTable, number_of
from rtamt.language.parsing.imports import library_of
from rtamt.language.printing.printer import to_text
from rtamt.signals.trace import Trace
from rtamt.violations import first_violation

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from typing_extensions import Unpack

    from rtamt.engine import OnlineMonitor, Query
    from rtamt.fleet.groups import Group
    from rtamt.settings import EvaluationSettings
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification
    from rtamt.verdicts.prepared import Found

    Read = Callable[[Way, Specification | None], tuple[Specification | None, Trace]]


class Suite:
    """Many requirements, compiled once into few programs, over any number of recordings.

    ``specs``: specifications, or a mapping from a name to a specification; each requirement in them has its own row,
    and each is named by ``require NAME``, else by the name of its specification, else by its text.
    ``select``: what is computed, of ``"robustness"``, ``"satisfied"`` and ``"first_violation"``; to leave out the
    robustness, or the other two, halves state and work. The other settings are those of
    :meth:`Specification.evaluate`.

    The values are those of :meth:`Specification.evaluate` on each requirement, bit for bit. Without the robustness,
    they are those of ``semantics="boolean"``, which compares infinities whose difference has no value. Samples must be
    complete: a missing one is an error in the rows of the requirements that read it. Programs are split so that
    the registers of each fit the second-level cache. A suite is pickled as bytes of programs, see :meth:`to_bytes`.

    >>> import rtamt
    >>> suite = rtamt.Suite([rtamt.parse("require LOW: always(x <= 9); require HIGH: always(x >= 3)", period=1)])
    >>> [(row.requirement, row.robustness, row.satisfied) for row in suite.evaluate({"x": [5, 2]})]
    [('LOW', 4.0, True), ('HIGH', -1.0, False)]
    """

    def __init__(
        self,
        specs: Specification | Iterable[Specification] | Mapping[str, Specification],
        *,
        select: Iterable[str] = SELECTABLE,
        tolerance: float | None = None,
        **reading: Unpack[EvaluationSettings],
    ) -> None:
        self.select = _select(select)
        robustness = "robustness" in self.select
        truth = len(self.select) > robustness
        every = named_requirements(specs)
        asked = {}
        for number, (name, spec) in enumerate(every):
            query = _query_of(name, spec, {"tolerance": tolerance, **reading})
            asked[number] = Asking(spec, query, robustness, truth)
        self.requirements = tuple(SuiteRequirement.of(name, spec) for name, spec in every)
        self._specs = dict(every)
        self._settings: dict[str, Any] = {"tolerance": tolerance, **reading}
        self._groups, why = grouped(asked)
        self._apart = {number: (every[number][1], why[number]) for number in why}

    # ---- evaluation ------------------------------------------------------------------------------

    def evaluate(
        self, data: Any, *, recording: str = "", signals: Collection[str] | None = None
    ) -> VerdictTable:
        """Evaluate all requirements on one complete trace: a row for each, in their order.

        ``data`` as for :meth:`Specification.evaluate`, with the variables of all requirements; ``recording``: its
        name in the table. ``signals``: the names in the recording, of which ``data`` need only have those of the
        requirements that can be checked. Wrong data and undefined values become the error in the rows of the
        requirements that they concern.
        """
        rows = self._unchecked(recording, data if isinstance(data, Trace) else _names_of(data))
        if signals is not None:
            rows |= self._unchecked(
                recording, signals
            )  # with the names that the recording lacks, not the data
        for group in self._groups:
            kept = [number for number in group.inputs if number not in rows]
            if kept:
                for number, found, trace in group.of(kept).evaluate(data):
                    rows[number] = self._row(recording, number, found, trace)
        for number, (spec, _) in self._apart.items():
            if number not in rows:
                rows[number] = self._row_apart(recording, number, spec, data)
        return VerdictTable([rows[number] for number in range(len(self.requirements))], self.select)

    def evaluate_apart(self, signals: Collection[str], read: Read, *, recording: str = "") -> VerdictTable:
        """Evaluate each requirement on a trace of its own; rows as of :meth:`evaluate`.

        ``signals``: the names in the recording. ``read``: returns the specification to evaluate and its trace from the
        way in which a requirement reads recordings and its specification; both are None where a common program holds
        the requirement.
        """
        rows = self._unchecked(recording, signals)
        for number, requirement in enumerate(self.requirements):
            if number not in rows:
                try:
                    rows[number] = self._row_of(recording, number, read)
                except StlError as error:
                    rows[number] = Row(recording, requirement.name, error=str(error))
        return VerdictTable([rows[number] for number in range(len(self.requirements))], self.select)

    def _row_of(self, recording: str, number: int, read: Read) -> Row:
        if number in self._apart:
            spec, _ = self._apart[number]
            over, data = read(way_of(spec), spec)
            return self._row_apart(recording, number, over or spec, data)
        group = self._group_of(number)
        _, data = read(group.way, None)
        ((_, found, trace),) = group.evaluate(data)
        return self._row(recording, number, found, trace)

    def _unchecked(self, recording: str, signals: Collection[str] | Trace) -> dict[int, Row]:
        """Return the rows of the requirements whose optional variables a recording lacks."""
        rows = {}
        for number, requirement in enumerate(self.requirements):
            reason = requirement.optional.unchecked(signals) if requirement.optional.columns else ""
            if reason:
                rows[number] = Row(recording, requirement.name, unchecked=f"not checked: {reason}")
        return rows

    def _row(self, recording: str, number: int, found: Found | StlError, trace: DomainTrace | None) -> Row:
        name = self.requirements[number].name
        if isinstance(found, StlError):
            return Row(recording, name, error=str(found))
        at = None if found.violation is None or trace is None else number_of(trace.time(found.violation))
        return Row(
            recording,
            name,
            found.robustness,
            found.satisfied if "satisfied" in self.select else None,
            at if "first_violation" in self.select else None,
            error=None if found.error is None else str(found.error),
        )

    def _row_apart(self, recording: str, number: int, spec: Specification, data: Any) -> Row:
        """Return the row of a requirement that has its own program."""
        name, robustness, violated, satisfied = self.requirements[number].name, None, None, None
        settings = dict(self._settings)
        if "robustness" not in self.select:
            settings["semantics"] = "boolean"
        try:
            result = spec.evaluate(data, **settings)
            robustness = result.robustness if "robustness" in self.select else None
            if len(self.select) > ("robustness" in self.select):
                satisfied = result.satisfied
                violated = None if satisfied else number_of(first_violation(result))
        except StlError as error:
            return Row(recording, name, robustness, error=str(error))
        return Row(
            recording,
            name,
            robustness,
            satisfied if "satisfied" in self.select else None,
            violated if "first_violation" in self.select else None,
        )

    # ---- bytes -----------------------------------------------------------------------------------

    def to_bytes(self) -> bytes:
        """Return the suite as bytes: its programs, and how recordings are read, without any formula.

        Raises :class:`UsageError` for a requirement that bytes cannot hold: over members of groups, with a custom
        operator, or with a sampling period that each recording decides.

        >>> import rtamt
        >>> suite = rtamt.Suite([rtamt.parse("always(x >= 3)", period="100ms")])
        >>> rtamt.Suite.from_bytes(suite.to_bytes()).evaluate({"x": [5, 4]}) == suite.evaluate({"x": [5, 4]})
        True
        """
        for number, (_, why) in self._apart.items():
            raise UsageError(
                f"the requirement '{self.requirements[number].name}' cannot be stored with a suite: it {why}; "
                f"leave it out, and evaluate it by itself"
            )
        for group in self._groups:
            if group.way.domain.step is None:
                name = self.requirements[next(iter(group.inputs))].name
                raise UsageError(
                    f"the requirement '{name}' cannot be stored with a suite: it has no sampling period, in which its "
                    f"bounds are counted; give one, such as Suite(specs, period='100ms')"
                )
        return self._bytes

    @cached_property
    def _bytes(self) -> bytes:
        return packed(self.select, self.requirements, self._groups)

    @staticmethod
    def from_bytes(code: bytes | bytearray | memoryview) -> Suite:
        """Read a suite that :meth:`to_bytes` wrote; nothing is parsed or compiled.

        The bytes need not be trusted: they are verified. Raises :class:`UsageError` for anything else.
        """
        select, requirements, groups = unpacked(code)
        suite = Suite.__new__(Suite)
        suite.select, suite.requirements = select, requirements
        suite._settings, suite._groups, suite._apart, suite._specs = {}, groups, {}, {}
        return suite

    def __reduce__(self) -> tuple[Any, ...]:
        return Suite.from_bytes, (self.to_bytes(),)

    def monitor(self) -> tuple[OnlineMonitor, tuple[Specification, ...]]:
        """Return a monitor that watches every requirement by its name, and their specifications.

        Raises :class:`UsageError` if the requirements need more than one monitor, or have no formulas.
        """
        self._require_formulas()
        if self._apart or len(self._groups) > 1 or self._groups[0].way.rule is not None:
            raise _apart_in_fleets()
        return self._groups[0].monitor([each.name for each in self.requirements]), tuple(self._specs.values())

    def monitors(self, settings: Mapping[str, Any]) -> dict[str, tuple[Specification, OnlineMonitor]]:
        """Return a monitor of each requirement, and its specification, by its name; ``settings``: beside those here.

        Raises :class:`UsageError` if the requirements do not share a time domain, or have no formulas.
        """
        specs = self.specifications
        if len({(way.domain, way.unit) for way in self.ways}) > 1:
            raise _apart_in_fleets()
        given = {name: setting for name, setting in self._settings.items() if setting is not None}
        if "robustness" not in self.select:
            given["semantics"] = "boolean"
        found = {}
        for name, spec in specs.items():
            spec.require_no_groups("a fleet")
            try:
                found[name] = spec, spec.monitor(**given, **settings)
            except StlError as error:
                raise placed(error, name) from None
        return found

    @property
    def specifications(self) -> Mapping[str, Specification]:
        """The specification of each requirement, by its name; raises :class:`UsageError` if there are none."""
        self._require_formulas()
        return self._specs

    def _require_formulas(self) -> None:
        if not self._specs:
            raise UsageError(
                "a suite that was read from bytes has no formulas to monitor; make the fleet of Suite(specs)"
            )

    @property
    def storable(self) -> bool:
        """Whether :meth:`to_bytes` takes the suite."""
        return not self._apart and all(group.way.domain.step is not None for group in self._groups)

    @cached_property
    def fingerprint(self) -> str:
        """A hash of the computation: that of the bytes or, without bytes, of texts and settings."""
        if self.storable:
            return hashlib.sha256(self.to_bytes()).hexdigest()
        described: list[Any] = [self.select, sorted(self._settings.items(), key=str)]
        for name, spec in self._specs.items():
            document = spec.document
            texts = (spec.text, document.selected, library_of(document), to_text(spec.formula))
            read = (spec.period, spec.semantics, dict(spec.roles), spec.binding, spec.sampling, spec.backend)
            described.append((name, spec.domain, *texts, dict(spec.parameters), *read))
        return hashlib.sha256(repr(described).encode()).hexdigest()

    def sent(self) -> tuple[Callable[..., Suite], tuple[Any, ...]]:
        """Return a function and its arguments that make the suite in another process, with parsing if need be.

        A pickle of a suite has no formulas; this has the specifications of a suite that is not :attr:`storable`.
        """
        if self.storable:
            return Suite.from_bytes, (self.to_bytes(),)
        return _rebuild, (self._specs, self.select, self._settings)

    @property
    def ways(self) -> tuple[Way, ...]:
        """The reading settings of recordings for the requirements."""
        apart = [way_of(spec) for spec, _ in self._apart.values()]
        return (*(group.way for group in self._groups), *apart)

    def ways_over(self, signals: Collection[str]) -> tuple[Way, ...]:
        """The same for the requirements whose optional variables a recording has; ``signals``: its names."""
        lacking = self._unchecked("", signals)
        if not lacking:
            return self.ways
        kept = [[number for number in group.inputs if number not in lacking] for group in self._groups]
        together = [
            group.of(numbers).way for group, numbers in zip(self._groups, kept, strict=True) if numbers
        ]
        apart = [way_of(spec) for number, (spec, _) in self._apart.items() if number not in lacking]
        return (*together, *apart)

    @property
    def each_way(self) -> tuple[Way, ...]:
        """The reading settings of recordings for each requirement alone."""
        return tuple(
            way_of(self._apart[number][0]) if number in self._apart else self._group_of(number).way
            for number in range(len(self.requirements))
        )

    def _group_of(self, number: int) -> Group:
        """Return the group of a requirement alone."""
        return next(group for group in self._groups if number in group.inputs).of([number])

    @property
    def recorded(self) -> tuple[str, ...]:
        """All names in recordings that the requirements may read; of members of groups their beginnings."""
        groups = [group for spec, _ in self._apart.values() for group, _ in spec.groups.values()]
        names = (name for way in self.ways for name in way.binding.recorded)
        return tuple(dict.fromkeys((*names, *(group.beginning for group in groups))))

    @property
    def reads_everything(self) -> bool:
        """Whether a requirement reads the members of groups, which each recording decides."""
        return any(spec.groups for spec, _ in self._apart.values())

    @property
    def input_names(self) -> tuple[str, ...]:
        """The variables that the requirements read, in order of appearance."""
        return tuple(dict.fromkeys(name for way in self.ways for name in way.inputs))

    def __len__(self) -> int:
        return len(self.requirements)

    def __repr__(self) -> str:
        return f"<suite of {len(self)} requirements: {', '.join(self.select)}>"


def _apart_in_fleets() -> UsageError:
    return UsageError(
        "the requirements of a fleet share the time domain, the sampling period, and the names, units and "
        "types of their variables, without a sampling rule, quantifiers or operators of your own; make a "
        "fleet for each that differs"
    )


def _rebuild(specs: Mapping[str, Specification], select: Sequence[str], settings: dict[str, Any]) -> Suite:
    return Suite(specs, select=select, **settings)


def _query_of(name: str, spec: Specification, settings: dict[str, Any]) -> Query:
    try:
        return spec._query(**settings)
    except StlError as error:
        raise placed(error, name) from None


def _select(select: Iterable[str]) -> tuple[str, ...]:
    if isinstance(select, str):
        raise UsageError(f"select is the text '{select}'; give a list of names, such as ['{select}']")
    if not isinstance(select, Iterable):
        raise UsageError(f"select is {shown(select)}; give a list of names, such as ['robustness']")
    names = list(select)
    for name in names:
        if name not in SELECTABLE:
            raise UsageError(
                f"a suite cannot select {shown(name)}{choices(str(name), SELECTABLE, 'columns')}"
            )
    if not names:
        raise UsageError(f"a suite selects nothing: give one or more of {', '.join(SELECTABLE)}")
    return tuple(name for name in SELECTABLE if name in names)


def _names_of(data: Any) -> Sequence[str]:
    names = getattr(data, "columns", data)
    return [str(name) for name in names] if hasattr(names, "__iter__") else []
