"""Mutation analysis: which mutants of a requirement recordings distinguish from it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.fleet.suite import Suite
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.mutation.mutants import Mutant, mutants_of
from rtamt.specification import Specification

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from rtamt.settings import EvaluationSettings


@dataclass(frozen=True)
class Mutation:
    """The mutants of a specification, and which recording distinguishes ("kills") which of them.

    ``killed``: a row for each mutant and a column for each recording: whether the verdict of the mutant at the start
    differs from that of its requirement, or cannot be computed although that of the requirement can.
    """

    specification: Specification
    mutants: tuple[Mutant, ...]
    recordings: tuple[str, ...]
    killed: NDArray[np.bool_]

    @property
    def score(self) -> float:
        """The share of the mutants that some recording distinguishes; 1 if there are no mutants."""
        return float(self.killed.any(axis=1).mean()) if self.mutants else 1.0

    @property
    def survivors(self) -> tuple[Mutant, ...]:
        """The mutants that no recording distinguishes."""
        return tuple(m for m in self.mutants if not self.killed[m.number - 1].any())

    def killers(self, mutant: Mutant) -> tuple[str, ...]:
        """Return the recordings that distinguish a mutant."""
        row = self.killed[mutant.number - 1]
        return tuple(name for name, kills in zip(self.recordings, row, strict=True) if kills)

    @cached_property
    def alone(self) -> dict[str, int]:
        """For each recording, the number of mutants that it alone distinguishes."""
        once = self.killed.sum(axis=1) == 1
        return dict(zip(self.recordings, map(int, self.killed[once].sum(axis=0)), strict=True))

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return {
            "score": self.score,
            "mutants": [
                {
                    "name": mutant.name,
                    "requirement": mutant.requirement,
                    "kind": mutant.kind,
                    "change": mutant.change,
                    "line": mutant.line,
                    "column": mutant.column,
                    "killed_by": list(self.killers(mutant)),
                }
                for mutant in self.mutants
            ],
            "recordings": [
                {"name": name, "kills": int(kills), "alone": self.alone[name]}
                for name, kills in zip(self.recordings, self.killed.sum(axis=0), strict=True)
            ],
        }

    def plot(self, axes: Any = None) -> Any:
        """Plot a matrix: which recording distinguishes which mutant; returns the axes. Needs ``rtamt[plot]``."""
        from rtamt.mutation.plot import matrix

        return matrix(self, axes)

    def __repr__(self) -> str:
        dead = len(self.mutants) - len(self.survivors)
        return f"<{dead} of {len(self.mutants)} mutants killed by {len(self.recordings)} recordings>"


def mutate(
    spec: Specification,
    recordings: Mapping[str, Any] | Iterable[Any],
    **reading: Unpack[EvaluationSettings],
) -> Mutation:
    """Evaluate the mutants of the requirements of a specification on recordings.

    ``recordings``: from a name to a recording, each as for :meth:`Specification.evaluate`; without names they are
    called by their numbers, from 0. The other settings are those of :meth:`Specification.evaluate`. All mutants are
    compiled into common programs. The result depends on nothing but the specification and the recordings.

    Raises :class:`TraceError`, with the name of the recording, where a requirement itself cannot be evaluated.

    >>> import rtamt
    >>> spec = rtamt.parse("always(x >= 3)")
    >>> found = mutate(spec, {"low": {"x": [5, 2]}, "high": {"x": [9, 8]}})
    >>> found, [mutant.change for mutant in found.survivors]
    (<4 of 7 mutants killed by 2 recordings>, ['x >= 3 → x > 3', 'x >= 3 → x >= 3.3', 'x >= 3 → x >= 2.7'])
    """
    if not isinstance(spec, Specification):
        raise UsageError(f"mutate takes a specification, got {shown(spec)}; rtamt.parse reads text")
    named = _name_recordings(recordings)
    suite = Suite(spec, select=["satisfied"], **reading)
    verdicts: dict[str, dict[str, bool | None]] = {}
    for name, data in named.items():
        rows = list(suite.evaluate(data, recording=name))
        for found in rows:
            if found.error is not None:
                raise TraceError(f"{name}: {found.error}")
        verdicts[name] = {each: row.satisfied for each, row in zip(spec.requirements, rows, strict=True)}
    timed = _choose_domain(spec, reading)
    mutants = mutants_of(timed, _step(timed, named, verdicts, reading))
    killed = np.zeros((len(mutants), len(named)), bool)
    if mutants:
        changed = Suite({each.name: each.specification for each in mutants}, select=["satisfied"], **reading)
        for column, (name, data) in enumerate(named.items()):
            for row, (mutant, found) in enumerate(zip(mutants, changed.evaluate(data), strict=True)):
                killed[row, column] = found.satisfied != verdicts[name][mutant.requirement]
    return Mutation(spec, tuple(mutants), tuple(named), killed)


def _name_recordings(recordings: Any) -> dict[str, Any]:
    if isinstance(recordings, Mapping):
        named = {str(name): data for name, data in recordings.items()}
    elif isinstance(recordings, Iterable) and not isinstance(recordings, str):
        named = {str(number): data for number, data in enumerate(recordings)}
    else:
        raise UsageError(
            f"recordings is {shown(recordings)}; give a list of recordings, or a mapping from names"
        )
    if not named:
        raise UsageError("there is no recording; give one or more, which the mutants are evaluated on")
    return named


def _choose_domain(spec: Specification, reading: Mapping[str, Any]) -> Specification:
    """Return the specification in the time domain that the settings choose."""
    chosen = {name: reading[name] for name in ("time", "period", "resolution") if name in reading}
    domain = spec._domain_for(**chosen)
    return (
        spec if domain is spec.domain else replace(spec, domain=domain, period=domain.period or spec.period)
    )


def _step(
    spec: Specification,
    named: Mapping[str, Any],
    verdicts: Mapping[str, Mapping[str, bool | None]],
    reading: Mapping[str, Any],
) -> Fraction | None:
    """Return the unit of bounds: the sampling period, or a multiple of those that the recordings determine."""
    if not spec.domain.sampled or spec.period is not None:
        return spec.period
    periods = {
        spec.requirements[requirement].evaluate(data, **reading).trace.domain.period
        for name, data in named.items()
        for requirement, verdict in list(verdicts[name].items())[:1]
        if verdict is not None
    }
    return _multiple({period for period in periods if period is not None})


def _multiple(periods: set[Fraction]) -> Fraction | None:
    """Return the least duration that is a multiple of each sampling period."""
    if not periods:
        return None
    return Fraction(lcm(*(p.numerator for p in periods)), gcd(*(p.denominator for p in periods)))
