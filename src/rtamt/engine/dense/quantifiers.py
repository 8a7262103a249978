"""The dense-time monitor of formulas with quantifiers, over members that come and go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.member_executors import Executor, Part, QuantifierExecutor
from rtamt.engine.dense.monitor import DenseMonitor, known_ticks, push_ticks
from rtamt.engine.dense.steps import Inputs, member_of
from rtamt.engine.quantifiers import Plan, QuantifierMonitor
from rtamt.errors import TraceError
from rtamt.language.units.durations import check_unit
from rtamt.lazy.modules import np
from rtamt.signals import arrays, dense_arrays, members
from rtamt.signals.data_errors import missing_field, nan_of_members
from rtamt.signals.gaps import gaps_of
from rtamt.signals.member_chunks import fields_on_own_time_bases
from rtamt.signals.samples import time_of
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import TimeScale
from rtamt.usage_guard import exclusive

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from rtamt.engine.online import Watched
    from rtamt.language.formula import Formula
    from rtamt.language.quantifiers import Group
    from rtamt.rewrite.quantifier_streams import Quantified
    from rtamt.signals.dense import Dense
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.members import Fields


class DenseMemberMonitor(QuantifierMonitor):
    """Monitors a formula with quantifiers on signals that change at any instant.

    Built by ``Specification.monitor(time="dense")``. :meth:`update` takes the fields of each member by name,
    ``**{"car_3.x": 5.0}``, or as an object with those fields, ``car_3=car``. A field holds its value until its next
    sample; None ends the presence of the member. Members do not delay the result: it is known up to the earliest last
    sample of any other variable, so a sample of a member arrives before that of the other variables, or with it.

    >>> import rtamt
    >>> monitor = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > ego').monitor(time="dense")
    >>> monitor.update(0.0, ego=1.0, **{"car_1.x": 3.0}).points()
    [(0.0, 2.0)]
    >>> monitor.update(1.5, ego=1.0, **{"car_1.x": None, "car_2.x": 1.5}).points()
    [(1.5, 0.5)]
    """

    def __init__(
        self,
        formula: Formula,
        domain: Dense,
        quantified: Sequence[Quantified],
        fields: Fields,
        *,
        text: str | None = None,
        backend: str = "cpp",
        watch: Sequence[Watched] = (),
        unit: str | None = None,
        **settings: Any,
    ) -> None:
        # ``settings``: ``names``, ``declared``, ``factory`` and ``types`` of :class:`QuantifierMonitor`.
        def template(of: Quantified) -> DenseMonitor:
            return Executor(of.formula, domain, text=text, backend=backend)

        self._tick = domain.resolution
        self._unit = None if unit is None else check_unit(unit)
        super().__init__(
            DenseMonitor(formula, domain, text=text, backend=backend, watch=watch),
            [Plan(each, domain.resolution, template, fields) for each in quantified],
            fields,
            watch=watch,
            **settings,
        )

    def _begin(self) -> None:
        """See :class:`QuantifierMonitor`."""
        self._inputs = Inputs(self.input_names)
        self._scale: TimeScale | None = None
        #: The last tick that is reported, once the trace has ended.
        self._end: int | None = None
        #: The last point of each formula that is watched.
        self._seen: dict[Any, tuple[int, float]] = {}
        super()._begin()

    def _executors(self) -> list[QuantifierExecutor]:
        """See :class:`QuantifierMonitor`."""
        return [QuantifierExecutor(plan, {}) for plan in self._plans]

    @property
    def samples(self) -> int:
        """The number of samples of any variable since the start or the last reset."""
        return self._inputs.samples

    # ---- samples ---------------------------------------------------------------------------------

    @exclusive
    def update(self, /, *given: Any, **values: Any) -> Signal:
        """Take the values of any variables at one instant: seconds, numbers in ``time_unit=``, or a datetime.

        Returns the newly known robustness. Raises :class:`TraceError` for wrong data and :class:`EvaluationError`
        where an operation has no value; the monitor is then unchanged.
        """
        time = time_of(given)
        return self._take({name: ([time], [value]) for name, value in self._read(values).items()}, [time])

    @exclusive
    def update_many(self, data: Any) -> Signal:
        """Take samples: a mapping from variable to (times, values), or to [time, value] pairs.

        Variables may be left out or have no samples. Returns and raises as :meth:`update` does.
        """
        arrays.require_no_unit(data, self._unit)
        data = self._binding.applied(data, partial=True)
        fields = fields_on_own_time_bases(data, self._fields)
        unread = {
            name for name in members.names_of(data) if name in self._declared or self._is_of_member(name)
        }
        own = dense_arrays.columns_of(data, self.input_names, unread)
        return self._take({**fields, **own})

    @exclusive
    def finish(self) -> Signal:
        """End the trace: every signal holds its last value. Returns the rest of the robustness."""
        empty = Signal(np.empty(0), np.empty(0))
        if self._finished:
            return empty
        for name in self.input_names:
            if name not in self._inputs.last:
                raise TraceError(f"'{name}' has no samples; provide one before finish()", variable=name)
        for group, fields in self._fields.values():
            for member in dict.fromkeys(self._members_of(group, self._inputs.first)):
                lacking = self._inputs.lacking([f"{member}.{field}" for field in fields])
                if lacking is not None:
                    raise missing_field(member, lacking.removeprefix(f"{member}."))
        end, scale = self._inputs.end, self._scale
        if end is None or scale is None or (self._inputs.frontier is None and self._inputs.start is None):
            self._finished = True
            return empty
        self._end = end
        try:
            known = self._run(end + int(self._outer._depth / self._tick), scale)
        except Exception:
            self._go_back()
            raise
        self._finished = True
        return self._signal(known)

    def __getitem__(self, name: str | Formula) -> Signal:
        """Return the new values of a watched formula after the last update; see ``DenseMonitor``."""
        ticks, values = known_ticks(self._outer, name)
        if self._end is not None and len(ticks) and ticks[-1] > self._end:
            count = int(ticks.searchsorted(self._end, "right"))
            reported, before = self._seen.get(name, (None, 0.0))
            ticks, values = ticks[:count], values[:count]
            if (int(ticks[-1]) if count else reported) != self._end:
                ticks, values = (
                    np.append(ticks, self._end),
                    np.append(values, values[-1] if count else before),
                )
        return self._signal((ticks, values))

    # ---- arguments -------------------------------------------------------------------------------

    def _is_of_member(self, name: str) -> bool:
        """Return whether a name is that of a member or of one of its fields."""
        return any(group.matches(name) or group.member(name) for group, _ in self._fields.values())

    def _is_field(self, name: str) -> bool:
        """Return whether a name is that of a field that formulas read."""
        found = [(group.member(name), fields) for group, fields in self._fields.values()]
        return any(parts is not None and parts[1] in fields for parts, fields in found)

    def _read(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of an update by variable and by field."""
        found, given = self._partition(values)
        for name in values:
            if values[name] is None:
                for group, fields in self._fields.values():
                    if group.matches(name):
                        given.setdefault(name, {}).update(dict.fromkeys(fields))
        for member_name, fields_given in given.items():
            columns = {f"{member_name}.{field}": value for field, value in fields_given.items()}
            found |= {name: value for name, value in columns.items() if self._is_field(name)}
        return found

    def _take(self, columns: Mapping[str, tuple[Any, Any]], times: Sequence[Any] = ()) -> Signal:
        """Take columns of samples; ``times``: of an update, also without a value."""
        self._require_open()
        given = {name: column for name, column in columns.items() if len(column[0])}
        if self._scale is None and not given:
            return Signal(np.empty(0), np.empty(0))
        all_times = [each for each, _ in given.values()] or [times]
        if self._scale is None:
            scale = TimeScale.of(self._tick, all_times, self._unit)
        else:
            scale = self._scale.widened(all_times)
        now = int(scale.ticks(list(times), arrays.TIME)[0]) if times else None
        with nan_of_members(self._fields):
            chunk = {name: self._samples(name, column, scale) for name, column in given.items()}
        return self._signal(self._try_update(chunk, now, scale))

    def _samples(self, name: str, column: tuple[Any, Any], scale: TimeScale) -> Samples:
        """Return the samples of a variable; of a field, NaN where a None ends the presence of its member."""
        inputs, type_ = self._inputs, self._types.get(name)
        times, values = column
        gaps = None
        if name not in self.input_names:
            owners = [group for group, _ in self._fields.values() if group.member(name) is not None]
            fields = [group.values(parts[1]) for group in owners if (parts := group.member(name)) is not None]
            type_ = next((each for each in fields if each is not None), type_)
            gaps = gaps_of(values)
            values = members.filled(values, gaps, type_)
        count, last = inputs.counts.get(name, 0), inputs.last.get(name)
        ticks, numbers = dense_arrays.samples_of((times, values), name, scale, count, last, type_)
        if gaps is not None:
            numbers = np.where(gaps, np.nan, numbers)
        frontier = inputs.frontier
        if frontier is not None and ticks[0] <= frontier:
            raise TraceError(
                f"'{name}' has a sample at {scale.show(int(ticks[0]))}, and the result is known up to "
                f"{scale.show(frontier)} already; give samples of members before those of the other variables, "
                f"or with them",
                variable=name,
                index=count,
            )
        return ticks, numbers

    # ---- the slow path -----------------------------------------------------------------------------

    def _advance(self, chunk: Mapping[str, Samples], now: int | None, scale: TimeScale) -> Samples:
        """See :class:`QuantifierMonitor`."""
        self._inputs.take(chunk, now)
        self._scale = scale
        known = self._inputs.known
        if known is None or known == self._inputs.frontier:
            return push_ticks(self._outer, {}, scale)
        return self._run(known, scale)

    def _run(self, until: int, scale: TimeScale) -> Samples:
        """Evaluate the formulas up to a tick; return the newly known robustness."""
        if until == self._inputs.frontier:
            return push_ticks(self._outer, {}, scale)
        begin, parts = self._inputs.cut(until)
        part = Part(self._members(parts), until, scale)
        values = {name: parts[name] for name in self.input_names}
        for each in self._quantifiers:
            values[each.plan.column] = each.step(part, values, begin)
        chunk = {name: (values[name].ticks, values[name].values) for name in self._outer.input_names}
        known = push_ticks(self._outer, chunk, scale)
        for name in self._watched:
            ticks, watched = known_ticks(self._outer, name)
            if len(watched) and self._end is None:
                self._seen[name] = int(ticks[-1]), float(watched[-1])
        return known

    def _members(self, parts: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """Return the members of each group in a part of the stream; forget those that are absent from now on."""
        found: dict[str, dict[str, Any]] = {}
        gone: dict[str, list[str]] = {}
        for name, (group, fields) in self._fields.items():
            found[name] = {}
            for member in sorted(set(self._members_of(group, parts))):
                columns = [f"{member}.{field}" for field in fields]
                gone.setdefault(member, []).extend(columns)
                if all(column in parts for column in columns):
                    fillers = {field: members.filler(group.values(field)) for field in fields}
                    steps = {field: parts[column] for field, column in zip(fields, columns, strict=True)}
                    found[name][member] = member_of(steps, fillers)
        for columns in gone.values():
            if self._inputs.lacking(columns) is None:  # else the end of the trace reports what it lacks
                self._inputs.forget([column for column in columns if column not in self.input_names])
        return found

    @staticmethod
    def _members_of(group: Group, columns: Iterable[str]) -> list[str]:
        return [parts[0] for column in columns if (parts := group.member(column)) is not None]

    def _signal(self, known: Samples) -> Signal:
        ticks, values = known
        scale = self._scale or TimeScale.of(self._tick, [], self._unit)
        return Signal(scale.times(ticks), values)

    def _own(self) -> Any:
        """See :class:`QuantifierMonitor`."""
        return self._inputs.copied(), self._scale, self._end, dict(self._seen)

    def _set_own(self, own: Any) -> None:
        """See :class:`QuantifierMonitor`."""
        inputs, self._scale, self._end, seen = own
        self._inputs, self._seen = inputs.copied(), dict(seen)
