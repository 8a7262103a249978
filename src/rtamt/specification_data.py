"""What data go through before they are evaluated: groups, sampling rules, missing and uncertain samples.

Imported on use: data that the core reads directly need none of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.signals.trace_checks import require_own_clocks

if TYPE_CHECKING:
    from rtamt.engine import Query
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification


def over_data(spec: Specification, query: Query, data: Any) -> tuple[Specification, Any]:
    """Return the specification over the members of groups that data has, and data with their presence."""
    from rtamt.signals import members
    from rtamt.signals.trace import Trace

    rule = spec.sampling
    own_time_bases = query.domain.own_time_bases or (rule is not None and rule.hold)
    found = members.bound(
        spec.binding.applied(data),
        spec.groups,
        spec.input_names,
        own_time_bases=own_time_bases,
        source=data.source if isinstance(data, Trace) else "the data",
        regular=own_time_bases or query.domain.step is not None,
    )
    return spec.over(found.members), found.data


def require_times(spec: Specification, query: Query, data: Any) -> None:
    """Raise :class:`TraceError` if one of several requirements has no times that are its own.

    It needs a period that nothing gives, or others changed the clock of its signals.
    """
    if len(spec.requirements) < 2:
        return
    names = [one.input_names for one in spec.requirements.values()]
    require_own_clocks(data, names)
    if query.domain.sampled and query.domain.period is None:
        from rtamt.signals.assumed_period import require_times_of_each  # monitors do not wait for it

        require_times_of_each(data, names)


def sample(spec: Specification, query: Query, data: Any) -> Any:
    """Return data with the samples that the sampling rule takes of it."""
    if spec.sampling is None:
        return data
    rule = query.domain.sampling(spec.sampling)
    if rule is None or not rule.hold:
        return data
    from rtamt.signals.sampling import sampled

    return sampled(data, spec.input_names, rule, query.domain.period or rule.period, query.unit)


def record_inexact(
    spec: Specification, query: Query, data: Any, uncertainty: Any, ranges: Any
) -> DomainTrace:
    """Return a recording that may have missing and uncertain samples."""
    from rtamt.signals.inexact import Uncertainty

    declared = Uncertainty.of(uncertainty, ranges, spec.input_names)
    recording, missing = _record(spec, query, data)
    if spec.resolved is not None:
        recording = recording.ended_by(spec.resolved[0].input_names)
    if missing or uncertainty is not None:  # exact recordings are not checked
        declared = declared.within(spec.ranges)
    return declared.applied(recording, missing)


def _record(spec: Specification, query: Query, data: Any) -> tuple[DomainTrace, dict[str, Any]]:
    """Return a recording, and which samples of its variables are missing."""
    try:
        return query.record(data, spec.input_names, spec.types), {}
    except TraceError as error:
        if error.variable not in spec.input_names:
            raise
        from rtamt.signals.inexact import fill_gaps

        own_time_bases = query.domain.own_time_bases
        filled, missing = fill_gaps(data, spec.input_names, own_time_bases=own_time_bases)
        if not missing:
            raise
        return query.record(filled, spec.input_names, spec.types), missing
