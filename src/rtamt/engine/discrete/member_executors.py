"""Executors of quantifiers in discrete time, one for each present member.

A quantifier is compiled once, as a formula over one member. A new member is a copy of its monitor in the initial
state; that of an absent member runs until its samples can no longer matter.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

from rtamt.engine.discrete.monitor import Monitor
from rtamt.engine.quantifiers import QuantifierExecutor as Quantifier
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.engine.quantifiers import Plan

#: A member's fields at a sample, by name.
Sample = dict[str, float]


class Moment(NamedTuple):
    """Where a sample is in the trace, for errors: its index, its time, and whether that is a date of the caller."""

    sample: int
    seconds: float
    dated: bool


BEGIN = Moment(0, 0.0, False)


class Executor(Monitor):
    """The monitor of a quantifier's formula over one member."""

    #: Where its first sample is, and the member in words.
    origin: tuple[Moment, str] = (BEGIN, "")

    def _no_value(self, error: Any, *, dated: bool | None = None) -> Exception:
        begin, who = self.origin
        index = error.args[1]
        seconds = begin.seconds + index * float(self._period)
        where = at_sample(begin.sample + index, seconds, dated=begin.dated or bool(dated))
        found = undefined(self._session.culprit(error), where)
        return type(found)(f"{who}: {found}")


class QuantifierExecutor(Quantifier):
    """A quantifier: its compiled formula, and the executors of the members at present."""

    running: dict[str, _Running]

    def step(self, present: Mapping[str, Mapping[str, Sample]], values: Sample, at: Moment) -> float:
        """Take a sample; return what the members gave together at the instant one lag ago.

        ``present``: the members of each group that are present, with their fields. ``values``: of all other variables.
        ``at``: where the sample is.
        """
        plan = self.plan
        here = present[plan.group]
        for member in here:
            if member not in self.running and plan.differs(self.bound, member):
                self.running[member] = _Running(plan, self.binding(member), at)
        total = plan.none
        gone = []
        for member, running in self.running.items():
            sample = here.get(member)
            running.absent = 0 if sample is not None else running.absent + 1
            if plan.keep is not None and running.absent > plan.keep:
                gone.append(member)
                continue
            given = running.step(present, values, sample, at)
            if given is not None:
                total = plan.join.numbers(total, given)
        for member in gone:
            del self.running[member]
        return total

    def state(self) -> Any:
        """Return the state of all executors."""
        return {member: running.state() for member, running in self.running.items()}

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self.running = {}
        for member, each in state.items():
            self.running[member] = _Running(self.plan, self.binding(member), BEGIN)
            self.running[member].restore(each)


class _Running:
    """The executor of one member, and the quantifiers inside."""

    def __init__(self, plan: Plan, bound: Mapping[str, str], at: Moment) -> None:
        self.plan = plan
        self.executor: Executor = copy(plan.template)
        who = ", ".join(f"{variable} is {member}" for variable, member in bound.items())
        self.executor.origin = at, who
        self.inside = [QuantifierExecutor(inner, bound) for inner in plan.inside]
        self.absent = 0

    def step(
        self,
        present: Mapping[str, Mapping[str, Sample]],
        values: Sample,
        sample: Sample | None,
        at: Moment,
    ) -> float | None:
        plan = self.plan
        mine = dict(values)
        mine[plan.channel] = 0.0 if sample is None else 1.0
        for field, name in plan.fields.items():
            mine[name] = plan.fillers[field] if sample is None else sample[field]
        for inner in self.inside:
            mine[inner.plan.column] = inner.step(present, mine, at)
        given: float | None = self.executor.step(*[mine[name] for name in self.executor.input_names])
        return given

    def state(self) -> Any:
        return (
            self.executor._state(),
            self.executor.origin,
            self.absent,
            [each.state() for each in self.inside],
        )

    def restore(self, state: Any) -> None:
        own, self.executor.origin, self.absent, inside = state
        self.executor._resume(own)
        for inner, each in zip(self.inside, inside, strict=True):
            inner.restore(each)
