"""The recorded names and units of the variables of a specification, and the variables that may be missing."""

from __future__ import annotations

from functools import cached_property
from math import inf
from types import MappingProxyType

from rtamt.language.quantifiers import Declared
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.signals.binding import Binding
from rtamt.signals.time_columns import is_stamps
from rtamt.specification_text import SpecificationText

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.signals.trace import Trace


#: Missing signals that are named.
_NAMED = 3


class Optional(NamedTuple):
    """Variables that recordings may lack, each with its recorded names; ``rule``: how they are sampled."""

    columns: tuple[tuple[str, tuple[str, ...]], ...] = ()
    rule: Sampling | None = None

    def lacking(self, names: Collection[str] | Trace) -> dict[str, str]:
        """Return those that a recording with these signals lacks, each with its recorded names as text."""
        from rtamt.signals.sampling import without_values
        from rtamt.signals.trace import Trace

        aliases = names.aliases if isinstance(names, Trace) else {}
        empty = without_values(names, self.rule) if isinstance(names, Trace) else frozenset()
        recorded = {*names, *aliases}
        known = recorded - empty - {alias for alias, name in aliases.items() if name in empty}
        lacking = {}
        for name, columns in self.columns:
            if name not in known and known.isdisjoint(columns):
                only_nan = " other than NaN" if name in recorded or not recorded.isdisjoint(columns) else ""
                lacking[name] = " or ".join(f"'{column}'" for column in columns) + only_nan
        return lacking

    def unchecked(self, names: Collection[str] | Trace) -> str:
        """Return why a requirement that reads all of them cannot be checked; empty if it can."""
        lacking = self.lacking(names)
        return _format_missing(list(lacking.values())) if lacking else ""


class RecordedSpecification(SpecificationText):
    """One requirement or several, whose variables have names and units in recordings."""

    @cached_property
    def units(self) -> Mapping[str, str]:
        """The units that the text declares of the variables that the formula reads.

        >>> import rtamt
        >>> dict(rtamt.parse("input float v [km/h]; always(v <= 30)").units)
        {'v': 'km/h'}
        """
        declared = {d.name: d.unit for d in self.document.declarations if d.unit}
        return MappingProxyType({name: declared[name] for name in self.input_names if name in declared})

    @cached_property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        """The ranges that the text declares of the variables that the formula reads.

        They bound samples that are missing or not yet known; a sample outside is then an error.

        >>> import rtamt
        >>> dict(rtamt.parse("input float v in [0, 60]; always(v <= 30)").ranges)
        {'v': (0.0, 60.0)}
        """
        declared = {d.name: d.range for d in self.document.declarations if d.range is not None}
        return MappingProxyType({name: declared[name] for name in self.input_names if name in declared})

    @property
    def _unlimited(self) -> dict[str, tuple[float, float]]:
        """The value of ``ranges=`` that ignores declared ranges."""
        return dict.fromkeys(self.ranges, (-inf, inf))

    @cached_property
    def recorded(self) -> Mapping[str, str]:
        """The recorded names of the variables that the formula reads, as far as the text declares them.

        >>> import rtamt
        >>> spec = rtamt.parse('input float z [m] = "setpoint.position[2]"; always(z <= 3)')
        >>> dict(spec.recorded), spec.evaluate({"setpoint.position[2]": [1, 2]}).robustness
        ({'z': 'setpoint.position[2]'}, 1.0)
        """
        return MappingProxyType({name: columns[0] for name, columns in self._recorded_names.items()})

    @cached_property
    def _recorded_names(self) -> dict[str, tuple[str, ...]]:
        """Every recorded name of the variables that the formula reads, the preferred one first."""
        declared = {d.name: d.columns for d in self.document.declarations if d.columns}
        declared |= {name: (column,) for name, column in self.columns.items()}
        found = {}
        for name in self.input_names:
            head, dot, field_of = name.partition(".")
            if name in declared:
                found[name] = declared[name]
            elif dot and head in declared:
                found[name] = tuple(f"{column}.{field_of}" for column in declared[head])
        return found

    @cached_property
    def optional(self) -> frozenset[str]:
        """The variables that the formula reads and recordings may lack."""
        declared = {d.name for d in self.document.declarations if d.optional}
        return frozenset(
            name for name in self.input_names if name in declared or name.split(".")[0] in declared
        )

    def unchecked(self, names: Collection[str] | Trace) -> dict[str, str]:
        """Return the requirements that cannot be checked on a recording with these signals, each with the reason.

        These are the requirements that read an ``optional`` variable of which the recording has no recorded name or,
        if it is a trace and the text contains ``skip nan``, no sample but NaN.

        >>> import rtamt
        >>> spec = rtamt.parse('''
        ...     optional input float v [V] = "battery_status.voltage_v" or "battery.voltage"
        ...     input float z
        ...     require BAT: always(v >= 14)
        ...     require ALT: always(z <= 50)''')
        >>> spec.unchecked(["z", "battery.voltage"])
        {}
        >>> spec.unchecked(["z"])
        {'BAT': "no 'battery_status.voltage_v' or 'battery.voltage'"}
        """
        lacking = self._optional.lacking(names)
        return {
            name: _format_missing([lacking[each] for each in one.input_names if each in lacking])
            for name, one in self.requirements.items()
            if not lacking.keys().isdisjoint(one.input_names)
        }

    @cached_property
    def _optional(self) -> Optional:
        recorded = self._recorded_names
        return Optional(
            tuple((name, recorded.get(name, (name,))) for name in sorted(self.optional)), self.sampling
        )

    @cached_property
    def binding(self) -> Binding:
        """The recorded names of the variables of the formula, and their declared units."""
        others = {name: columns[1:] for name, columns in self._recorded_names.items() if len(columns) > 1}
        declared = {each.name for each in self.document.declarations}
        return Binding(
            self.input_names,
            tuple(self.recorded.items()),
            tuple(self.units.items()),
            tuple(others.items()),
            tuple(sorted(name for name in declared.difference(self.input_names) if is_stamps(name))),
        )

    @cached_property
    def _declared(self) -> Declared:
        """The names that the text declares: data may have them, also where the formula reads none of them."""
        names = frozenset(declaration.name for declaration in self.document.declarations)
        # Once members are known, data has these.
        return Declared(names, tuple(self.document.groups.values()) if self.resolved is None else ())


def _format_missing(missing: list[str]) -> str:
    """Return the missing signals as part of a sentence."""
    more = len(missing) - _NAMED
    return f"no {', '.join(missing[:_NAMED])}{f' and {more} more' if more > 0 else ''}"
