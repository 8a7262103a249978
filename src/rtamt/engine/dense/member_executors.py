"""Executors of quantifiers in dense time, one for each present member.

A quantifier is compiled once, as a formula over one member. A new member is a copy of its monitor in the initial
state; that of an absent member runs until its samples can no longer matter.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.monitor import DenseMonitor, push_ticks
from rtamt.engine.dense.steps import Steps, constant
from rtamt.engine.quantifiers import QuantifierExecutor as Quantifier
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.engine.dense.steps import Member
    from rtamt.engine.quantifiers import Plan
    from rtamt.errors import EvaluationError
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.ticks import TickArray, TimeScale


class Part(NamedTuple):
    """A part of a stream: the members of each group, its last tick, and the time scale."""

    members: Mapping[str, Mapping[str, Member]]
    end: int
    scale: TimeScale


class Executor(DenseMonitor):
    """The monitor of a quantifier's formula over one member."""

    #: The member in words.
    who = ""

    def _no_value(self, error: Exception, scale: TimeScale | None = None) -> EvaluationError:
        found = super()._no_value(error, scale)
        return type(found)(f"{self.who}: {found}")


class QuantifierExecutor(Quantifier):
    """A quantifier: its compiled formula, and the executors of the members at present."""

    running: dict[str, _Running]

    def __init__(self, plan: Plan, bound: Mapping[str, str]) -> None:
        super().__init__(plan, bound)
        #: What the members gave together last.
        self._last = plan.none

    def step(self, part: Part, values: Mapping[str, Steps], begin: int | None) -> Steps:
        """Take a part of the stream; return what the members give together, each value one lag after its instant.

        ``values``: of all variables but fields of members that are not bound yet. ``begin``: the first tick, if it is
        the first part.
        """
        plan = self.plan
        here = part.members[plan.group]
        for member, own in here.items():
            if member not in self.running and plan.differs(self.bound, member):
                birth = _first_present(own, begin)
                if birth is not None:
                    self.running[member] = _Running(plan, self.binding(member), birth)
        known = part.end - plan.lag
        given = [each.step(part, values, here.get(member)) for member, each in self.running.items()]
        for member in [member for member, each in self.running.items() if each.is_over(known)]:
            del self.running[member]
        ends = [known] if begin is None else [begin, known] if begin <= known else []
        ticks = merged([np.array(sorted(set(ends)), np.int64), *(each.ticks for each in given)])
        total = np.full(len(ticks), plan.none)
        for each in given:
            total = getattr(np, plan.join.columns)(total, each.at(ticks))
        return self._late(ticks, total, part.end, begin)

    def _late(self, ticks: TickArray, total: FloatArray, end: int, begin: int | None) -> Steps:
        """Return values as they become known: one lag later."""
        plan, before = self.plan, self._last
        ticks = ticks + plan.lag
        if begin is not None and plan.lag:  # nothing reads the column before its first value
            ticks, total = np.append(begin, ticks), np.append(plan.none, total)
        if ticks[-1] != end:
            ticks, total = np.append(ticks, end), np.append(total, total[-1])
        self._last = float(total[-1])
        return Steps(ticks, total, before)

    def state(self) -> Any:
        """Return the state of all executors."""
        return self._last, {member: running.state() for member, running in self.running.items()}

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self._last, members = state
        self.running = {}
        for member, each in members.items():
            self.running[member] = _Running(self.plan, self.binding(member), 0)
            self.running[member].restore(each)


class _Running:
    """The executor of one member, and the quantifiers inside. ``birth``: the tick at which it is first present."""

    def __init__(self, plan: Plan, bound: Mapping[str, str], birth: int) -> None:
        self.plan = plan
        self.executor: Executor = copy(plan.template)
        self.executor.who = ", ".join(f"{variable} is {member}" for variable, member in bound.items())
        self.inside = [QuantifierExecutor(inner, bound) for inner in plan.inside]
        self.birth: int | None = birth
        #: Since when it is absent, or a little later; None while it is present.
        self.gone: int | None = None
        #: What it gave last.
        self._last = plan.none

    def step(self, part: Part, values: Mapping[str, Steps], own: Member | None) -> Steps:
        """Take a part of the stream; return what the member gives at the instants that are known now."""
        plan, begin = self.plan, self.birth
        present = own is not None and own.channel.values.any()  # somewhere in the part
        if own is not None and own.channel.values[-1]:
            self.gone = None
        elif self.gone is None or present:
            self.gone = part.end
        mine = dict(values)
        mine[plan.channel] = constant(0.0, part.end) if own is None else own.channel
        for field, name in plan.fields.items():
            mine[name] = constant(plan.fillers[field], part.end) if own is None else own.fields[field]
        if begin is not None:
            mine = {name: steps.since(begin) for name, steps in mine.items()}
        for inner in self.inside:
            mine[inner.plan.column] = inner.step(part, mine, begin)
        chunk = {name: (mine[name].ticks, mine[name].values) for name in self.executor.input_names}
        ticks, given = push_ticks(self.executor, chunk, part.scale)
        self.birth = None
        before = self._last
        if len(given):
            self._last = float(given[-1])
        return Steps(ticks, given, before)

    def is_over(self, known: int) -> bool:
        """Return whether the member has been absent for so long that it no longer matters."""
        keep = self.plan.keep
        return keep is not None and self.gone is not None and known - self.gone > keep

    def state(self) -> Any:
        inside = [each.state() for each in self.inside]
        return self.executor._state(), self.executor.who, self.birth, self.gone, self._last, inside

    def restore(self, state: Any) -> None:
        own, self.executor.who, self.birth, self.gone, self._last, inside = state
        self.executor._resume(own)
        for inner, each in zip(self.inside, inside, strict=True):
            inner.restore(each)


def _first_present(member: Member, begin: int | None) -> int | None:
    """Return the first tick at which a member is present in a part of the stream; None if it is not."""
    channel = member.channel if begin is None else member.channel.since(begin)
    present = channel.values > 0
    return int(channel.ticks[int(present.argmax())]) if present.any() else None
