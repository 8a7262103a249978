"""The output groups of a node in a time domain: the part ``ros_groups`` of discrete and of dense time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.ros.early_group import EarlyDenseGroup, EarlyGroup, reports_of
from rtamt.ros.output_group import DenseGroup, DiscreteGroup, group_outputs

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.ros.binding import Output
    from rtamt.ros.group import MessageGroup, SampledGroup
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete


def sampled(outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Discrete) -> list[SampledGroup]:
    """Return groups that sample the latest messages once a period."""
    groups = [DiscreteGroup(group, topic_of, domain) for group in group_outputs(outputs)]
    early = (output for output in outputs if output.early)
    return [*groups, *(EarlyGroup(reports_of(output, domain), topic_of, domain) for output in early)]


def of_messages(outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Dense) -> list[MessageGroup]:
    """Return groups that take every message at its own time."""
    groups = [DenseGroup(group, topic_of, domain) for group in group_outputs(outputs)]
    early = (output for output in outputs if output.early)
    return [*groups, *(EarlyDenseGroup(reports_of(output, domain), topic_of) for output in early)]
