"""Check a recording in chunks, with memory use independent of its length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, no_specification, shown
from rtamt.language.formula import Apply
from rtamt.language.operators import STL
from rtamt.language.units.durations import check_unit
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import semantics_of
from rtamt.signals.data_errors import refuse_one_recording
from rtamt.signals.trace_checks import require_own_clocks
from rtamt.verdicts.chunks import Requirement, StreamResult
from rtamt.verdicts.decompose import anchor, check_in_chunks
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from fractions import Fraction

    from rtamt.language.units.durations import Duration
    from rtamt.settings import Semantics
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.specification import Specification


def check_stream(
    spec: Specification,
    chunks: Iterable[Any],
    *,
    time: str | TimeDomain | None = None,
    period: Duration | None = None,
    tolerance: float | None = None,
    semantics: Semantics | None = None,
    time_unit: str | None = None,
) -> StreamResult:
    """Check a recording in chunks, with memory use independent of its length.

    ``chunks``: the input of ``update_many``, such as the traces of :func:`rtamt.scan`.

    The other arguments and the numbers are those of ``Specification.evaluate``; by default, the period is
    inferred from the timestamps of the first chunk. The future of the formula must be bounded, except for ``always``
    and ``eventually`` at its top. Raises :class:`BoundError` if it is not, and the errors of ``evaluate``.

    >>> import rtamt
    >>> chunks = ({"time": [t, t + 1], "x": [5, 4 - t]} for t in (0, 2, 4))
    >>> result = rtamt.check_stream(rtamt.parse("always(x >= 1)"), chunks)
    >>> result.robustness, result.satisfied, result.first_violation, result.samples
    (-1.0, False, 5.0, 6)
    """
    if not hasattr(spec, "domain"):
        raise no_specification(spec)
    if not isinstance(chunks, Iterable):
        raise UsageError(f"chunks is {shown(chunks)}; give a list of recordings, or an iterator")
    refuse_one_recording(chunks, "chunks", ", or an iterator; spec.evaluate(data) takes one recording")
    domain = spec._domain_for(time, period, tolerance)
    rule = domain.sampling(spec.sampling)
    if rule is not None and rule.hold:
        raise UsageError(
            f"'{rule}' samples the whole recording; evaluate it, or sample the chunks and leave out 'hold'"
        )
    stream = _stream_of(domain)(spec, semantics, time_unit, domain)
    read = [one.input_names for one in spec.requirements.values()]
    for chunk in chunks:
        bound = spec.binding.applied(chunk, partial=domain.own_time_bases)
        require_own_clocks(bound, read)
        stream.take(bound)
    return stream.finish()


def _stream_of(domain: TimeDomain) -> Callable[..., Stream]:
    found: Callable[..., Stream] | None = domain.part("stream")
    if found is None:
        raise UsageError(f"recordings in {domain.name} time are not checked in chunks; evaluate them whole")
    return found


def check_streamable(spec: Specification) -> None:
    """Raise :class:`BoundError` where a formula needs the whole recording at once, else as :func:`check_stream`."""
    spec.require_no_groups("a check in chunks")
    _stream_of(spec.domain)
    for alone in spec.requirements.values():
        outputs = outputs_under(alone.formula, alone.semantics, alone.roles)
        check_in_chunks(anchor(outputs.robustness), alone.text)


def has_episodes(spec: Specification) -> bool:
    """Return whether a check in chunks determines the episodes of each requirement, as an evaluation does."""
    return all(
        horizon(alone.formula) is not None
        or (isinstance(alone.formula, Apply) and alone.formula.op is STL["always"])
        for alone in spec.requirements.values()
    )


class Stream(ABC):
    """Requirements over chunks; that of a time domain takes the time domain as well.

    ``unit``: of times that are numbers.
    """

    def __init__(self, spec: Specification, semantics: Semantics | None, unit: str | None) -> None:
        spec.require_no_groups("a check in chunks")
        if not spec.input_names:
            raise UsageError("the formula reads no variable, so that there is nothing to check in chunks")
        chosen = None if semantics is None else semantics_of(semantics)
        self.spec = spec
        self.unit = None if unit is None else check_unit(unit)
        self.declared = spec._declared
        self.requirements = {name: Requirement(one, chosen) for name, one in spec.requirements.items()}
        self.samples = 0
        #: Whether the period that was inferred from the first chunk is that of all chunks.
        self.steady = True

    @abstractmethod
    def take(self, chunk: Any) -> None:
        """Take the next chunk."""

    @abstractmethod
    def finish(self) -> StreamResult:
        """End the recording; return the outcome of all chunks."""

    def result(self, found: Mapping[str, StreamResult], period: Fraction | None) -> StreamResult:
        """Return the result over all chunks, from the results of the requirements."""
        results = tuple(found[name] for name in self.requirements)
        violations = [each.first_violation for each in results if not each.satisfied]
        minima = [each.minimum for each in results]
        return StreamResult(
            min(each.robustness for each in results),
            not violations,
            min(violations, default=None),
            None if None in minima else min(minimum for minimum in minima if minimum is not None),
            self.samples,
            period,
            min(each.start for each in results),
            results[0].episodes if len(results) == 1 else None,
            self.steady,
            MappingProxyType({name: found[name] for name in self.requirements}),
        )

    def require_samples(self) -> None:
        """Raise :class:`TraceError` where no chunk had a sample."""
        if not self.samples:
            raise TraceError("the trace is empty: give at least one sample")
