"""The base of the monitors of quantifiers of both time domains, over members that come and go.

The outer formula is monitored as any other: what the members of a quantifier give together is a column of it.
"""

from __future__ import annotations

from abc import abstractmethod
from copy import copy
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.language.contents import types_of
from rtamt.language.quantifiers import JOINS
from rtamt.rewrite.presence import channel_of
from rtamt.signals import arrays, members
from rtamt.signals.binding import Binding
from rtamt.signals.data_errors import unknown_variable
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine.online import OnlineMonitor, Watched
    from rtamt.rewrite.quantifier_streams import Quantified
    from rtamt.signals.members import Fields

#: After how many samples the state is remembered, from which a failed update goes back.
_REMEMBER = 64


class Plan:
    """The plan of a quantifier: its formula over one member, compiled once, and how members are combined."""

    def __init__(
        self, of: Quantified, step: Fraction, template: Callable[[Quantified], OnlineMonitor], fields: Fields
    ) -> None:
        self.variable, self.group = of.binder.variable, of.binder.group.name
        self.apart = of.binder.apart
        self.column, self.join = of.column, JOINS[of.kind]
        self.none = self.join.none
        #: In steps, as is ``keep``: after how many of absence a member no longer matters.
        self.lag = int(of.lag / step)
        self.keep = None if of.keep is None else int(of.keep / step) + self.lag + 1
        group, names = fields[self.group]
        self.fields = {name: f"{self.variable}.{name}" for name in names}
        self.fillers = {name: members.filler(group.values(name)) for name in names}
        self.channel = channel_of(self.variable)
        self.template: Any = template(of)
        # A quantifier that a condition reads has a column for its robustness and one for whether it holds.
        read = [each for each in of.inside if each.column in self.template.input_names]
        self.inside = [Plan(each, step, template, fields) for each in read]

    def differs(self, bound: Mapping[str, str], member: str) -> bool:
        """Return whether a member is another one than those that the quantifier keeps apart from it."""
        names = {**bound, self.variable: member}
        return all(names[one] != names[other] for one, other in self.apart)


class QuantifierExecutor:
    """A quantifier: its compiled formula, and what runs for each of the members at present.

    ``bound``: the members bound to the variables of the enclosing quantifiers.
    """

    def __init__(self, plan: Plan, bound: Mapping[str, str]) -> None:
        self.plan = plan
        self.bound = bound
        #: What runs for a member: ``executor``, and ``inside``, those of the quantifiers inside.
        self.running: dict[str, Any] = {}

    def binding(self, member: str) -> dict[str, str]:
        """Return the members bound to the variables inside the quantifier."""
        return {**self.bound, self.plan.variable: member}

    def executors(self) -> Iterator[Any]:
        """Yield the monitors of all members, also inside."""
        for running in self.running.values():
            yield running.executor
            for inner in running.inside:
                yield from inner.executors()


class QuantifierMonitor:
    """A monitor of a formula with quantifiers: the monitor of the outer formula, and an executor for each member."""

    _outer: Any
    #: For each quantifier that is not inside another one, what executes it.
    _quantifiers: list[Any]

    def __init__(
        self,
        outer: OnlineMonitor,
        plans: Sequence[Plan],
        fields: Fields,
        *,
        names: Sequence[str],
        watch: Sequence[Watched],
        declared: Collection[str] = (),
        factory: Callable[..., QuantifierMonitor] | None = None,
        types: Any = None,
    ) -> None:
        self._outer = outer
        self._plans = list(plans)
        self._fields = fields
        self._declared = declared
        self._factory = factory
        self._binding = Binding(tuple(names))
        self._watched = tuple(each.name for each in watch)
        self._types = {**types_of(outer._formulas[0]), **(types or {})}
        #: The variables that are not fields of members.
        self.input_names: tuple[str, ...] = tuple(names)
        self._usage = UsageGuard()
        self._begin()

    def _begin(self) -> None:
        """Forget the trace."""
        self._quantifiers = self._executors()
        self._finished = False
        self._remember()

    @abstractmethod
    def _executors(self) -> list[Any]:
        """Return executors of the quantifiers without members."""

    @abstractmethod
    def _advance(self, *given: Any) -> Any:
        """Take what was read of an update; whoever calls it goes back if it fails."""

    # ---- facts -----------------------------------------------------------------------------------

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known."""
        return float(self._outer.horizon)

    @property
    @abstractmethod
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""

    @property
    def memory(self) -> int:
        """The size of the state in bytes: the contents of the windows, of all members."""
        inner = sum(executor.memory for each in self._quantifiers for executor in each.executors())
        return int(self._outer.memory + inner)

    @property
    def members(self) -> tuple[str, ...]:
        """The monitored members, including absent ones that can still affect the result."""
        return tuple(dict.fromkeys(member for each in self._quantifiers for member in each.running))

    def bind(self, binding: Binding) -> None:
        """Find variables in chunks of recordings as a specification does."""
        self._binding = binding

    # ---- updates ---------------------------------------------------------------------------------

    def _note_member(self, name: str, value: Any, given: dict[str, dict[str, Any]]) -> bool:
        """Note a value of a member; return whether the name is that of one."""
        found = False
        for group, fields in self._fields.values():
            if group.matches(name):
                found = True
                if value is not None:
                    sample = given.setdefault(name, {})
                    sample |= {f: arrays.field_of(value, name, f.split("."), self.samples) for f in fields}
            elif (parts := group.member(name)) is not None:
                found = True
                given.setdefault(parts[0], {})[parts[1]] = value
        return found

    def _partition(self, values: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Return the values of an update by variable, and by member and field; raise at a name that is neither."""
        own: dict[str, Any] = {}
        given: dict[str, dict[str, Any]] = {}
        heads = {name.split(".")[0] for name in self.input_names}
        for name, value in values.items():
            member = self._note_member(name, value, given)
            if name in self.input_names or name in heads:
                own[name] = value  # of a member, too, if the pattern matches the name
            elif not member and name not in self._declared:
                patterns = [group.pattern for group, _ in self._fields.values()]
                raise unknown_variable(name, [*self.input_names, *patterns])
        for name in self.input_names:
            head, *path = name.split(".")
            if path and name not in own and own.get(head) is not None:
                own[name] = arrays.field_of(own[head], head, path, self.samples)
        return {name: own[name] for name in self.input_names if name in own}, given

    def _try_update(self, *given: Any) -> Any:
        """Take what was read of an update; if it fails, nothing has changed."""
        self._require_open()
        try:
            found = self._advance(*given)
        except Exception:
            self._go_back()
            raise
        self._since.append(given)
        if len(self._since) >= _REMEMBER:
            self._remember()
        return found

    def _require_open(self) -> None:
        if self._finished:
            raise UsageError("the monitor has finished its trace; call reset() before the next sample")

    @exclusive
    def reset(self, /, **parameters: float) -> None:
        """Forget the trace; the next sample is the first. ``parameters``: their values from now on."""
        if parameters:
            if self._factory is None:
                raise UsageError("only a monitor that Specification.monitor() has made has parameters")
            fresh = self._factory(parameters)
            self._outer, self._plans = fresh._outer, fresh._plans
        self._outer.reset()
        self._begin()

    # ---- states ----------------------------------------------------------------------------------

    def _state(self) -> Any:
        return self._outer._state(), [each.state() for each in self._quantifiers], self._finished, self._own()

    def _restore(self, state: Any) -> None:
        outer, quantifiers, self._finished, own = state
        self._outer._resume(outer)
        for each, of_one in zip(self._quantifiers, quantifiers, strict=True):
            each.restore(of_one)
        self._set_own(own)
        self._remember()

    def _own(self) -> Any:
        """Return the time-domain-specific part of the state."""

    def _set_own(self, own: Any) -> None:
        """Go back to it."""

    def _remember(self) -> None:
        self._before = self._state()
        self._since: list[tuple[Any, ...]] = []

    def _go_back(self) -> None:
        """Return to the state before an update that failed."""
        since = self._since
        self._restore(self._before)
        for given in since:
            self._advance(*given)
        self._since = since

    def __copy__(self) -> QuantifierMonitor:
        twin = type(self).__new__(type(self))
        twin.__dict__.update(self.__dict__)
        twin._usage = UsageGuard()
        twin._outer = copy(self._outer)
        twin._quantifiers = self._executors()
        twin._restore(self._state())
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> QuantifierMonitor:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        if self._factory is None:
            raise UsageError("only a monitor that Specification.monitor() has made can be pickled")
        return _rebuild, (self._factory, self._state())


def _rebuild(factory: Callable[[], QuantifierMonitor], state: Any) -> QuantifierMonitor:
    monitor = factory()
    monitor._restore(state)
    return monitor
