"""The parameter values that satisfy a template on every recording, evaluated within a budget."""

from __future__ import annotations

from contextlib import contextmanager
from functools import cached_property
from math import inf
from time import monotonic
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, TraceError, UsageError, shown
from rtamt.language.formula import Const, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.value_types import Enumeration
from rtamt.signals.arrays import is_number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification


class Spent(Exception):  # noqa: N818 - no error: it ends a search
    """The budget is spent."""


class Budget:
    """The limits on evaluations and seconds; ``progress`` is called with the number of evaluations."""

    def __init__(
        self, evaluations: int | None, timeout: float | None, progress: Callable[[int], None] | None
    ) -> None:
        if evaluations is not None:
            require_count("evaluations", evaluations, 1)
        if timeout is not None and (not is_number(timeout) or not timeout > 0):
            raise UsageError(f"timeout is {shown(timeout)}; give a number of seconds above 0")
        self.made = 0
        self._most = evaluations
        self._until = None if timeout is None else monotonic() + timeout
        self._progress = progress

    def take(self) -> None:
        """Count one evaluation; raise :class:`Spent` if none is left."""
        if self._most is not None and self.made >= self._most:
            raise Spent
        if self._until is not None and monotonic() > self._until:
            raise Spent
        self.made += 1
        if self._progress is not None:
            self._progress(self.made)


class Region:
    """The values with which a template is satisfied on every recording."""

    def __init__(
        self, spec: Specification, recordings: Mapping[str, Any], reading: Mapping[str, Any], budget: Budget
    ) -> None:
        self.spec = spec
        self.budget = budget
        self._recordings = recordings
        self._reading = reading
        self._order = list(recordings)
        self._known: dict[tuple[tuple[str, float], ...], str | None] = {}

    def holds(self, values: Mapping[str, float]) -> bool:
        """Return whether every recording satisfies the template with these values."""
        return self.violator(values) is None

    def violator(self, values: Mapping[str, float]) -> str | None:
        """Return a recording that violates the template with these values; None if there is none."""
        key = tuple(values.items())
        if key not in self._known:
            self._known[key] = self._first_violator(values)
        return self._known[key]

    def margin(self, values: Mapping[str, float]) -> tuple[float, bool]:
        """Return the least robustness over the recordings, and whether all of them satisfy the template."""
        spec = self.spec.with_parameters(**values)
        results = []
        for name in self._order:
            result = self._evaluate(spec, name, values)
            with _prefix_error(name, values):  # missing samples may leave both open
                results.append((result.robustness, result.satisfied))
        return min(robustness for robustness, _ in results), all(satisfied for _, satisfied in results)

    def trace(self, name: str) -> DomainTrace:
        """Return a recording as the template reads it."""
        return self._evaluate(self._reading_only, name, {}).trace

    @cached_property
    def _reading_only(self) -> Specification:
        """The specification of a formula that is true, and reads all variables of the template."""
        typed = {node.name: node for node in postorder(self.spec.formula) if isinstance(node, Var)}
        reads = [typed.get(name, Var(name)) for name in self.spec.input_names]
        true: Formula = Const(inf)
        for each in reads:
            # A member of an enumeration is no formula.
            read = STL["eq"](each, each) if isinstance(each.type, Enumeration) else each
            true = STL["or"](true, read)
        return self.spec.with_formula(true)

    def alone(self, name: str) -> Region:
        """Return the region of one recording, with the same budget."""
        return Region(self.spec, {name: self._recordings[name]}, self._reading, self.budget)

    def _first_violator(self, values: Mapping[str, float]) -> str | None:
        spec = self.spec.with_parameters(**values)
        for name in self._order:
            result = self._evaluate(spec, name, values)
            with _prefix_error(name, values):
                satisfied = result.satisfied
            if not satisfied:
                # The recording that decides one value mostly decides the next, too.
                self._order.remove(name)
                self._order.insert(0, name)
                return name
        return None

    def _evaluate(self, spec: Specification, name: str, values: Mapping[str, float]) -> Result:
        self.budget.take()
        with _prefix_error(name, values):
            return spec.evaluate(self._recordings[name], **self._reading)


@contextmanager
def _prefix_error(name: str, values: Mapping[str, float]) -> Iterator[None]:
    """Put the name of a recording, and the values, before an error."""
    try:
        yield
    except StlError as error:
        given = f", with {written(values)}" if values else ""
        raise TraceError(f"{name}{given}: {error}") from error


def written(values: Mapping[str, float]) -> str:
    """Return values as they are given on the command line.

    >>> written({"limit": 3.0, "within": 0.25})
    'limit=3, within=0.25'
    """
    return ", ".join(f"{name}={number(value)}" for name, value in values.items())


def number(value: float) -> str:
    """Return a number with all its digits, without a fraction of 0."""
    return repr(int(value)) if float(value).is_integer() and abs(value) < 1e16 else repr(float(value))


def require_count(what: str, given: Any, least: int) -> None:
    """Raise :class:`UsageError` unless a setting is a whole number that is large enough."""
    if not isinstance(given, int) or isinstance(given, bool) or given < least:
        raise UsageError(f"{what} is {shown(given)}; give a whole number of {least} or more")
