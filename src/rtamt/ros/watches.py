"""What a node runs in a time domain: the part ``watches`` of discrete and of dense time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.ros.early_watch import EarlyDenseWatch, EarlyWatch, reports_of
from rtamt.ros.output_group import DenseWatch, DiscreteWatch, group_outputs

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.ros.binding import Output
    from rtamt.ros.watch import MessageWatch, SampledWatch
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete


def sampled(outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Discrete) -> list[SampledWatch]:
    """Return watches that sample the latest messages once a period."""
    groups = [DiscreteWatch(group, topic_of, domain) for group in group_outputs(outputs)]
    early = (output for output in outputs if output.early)
    return [*groups, *(EarlyWatch(reports_of(output, domain), topic_of, domain) for output in early)]


def of_messages(outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Dense) -> list[MessageWatch]:
    """Return watches that take every message at its own time."""
    groups = [DenseWatch(group, topic_of, domain) for group in group_outputs(outputs)]
    early = (output for output in outputs if output.early)
    return [*groups, *(EarlyDenseWatch(reports_of(output, domain), topic_of) for output in early)]
