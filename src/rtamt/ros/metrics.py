"""The metrics of a node, from the records that its monitor returns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.ros.early_group import Bounds
from rtamt.ros.group import Robustness, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.metrics import Metrics
    from rtamt.ros.group import Record


def note(metrics: Metrics | None, records: Sequence[Record], now: int) -> None:
    """Note records at a time of the node's clock in nanoseconds; without metrics, do nothing.

    Verdicts that are not known yet are not counted.
    """
    if metrics is None or not records:
        return
    for record in records:
        if isinstance(record, Robustness):
            metrics.set("rtamt_robustness", record.value, requirement=record.output.name)
        elif isinstance(record, Verdict) and record.satisfied is not None:
            metrics.verdict(record.output.name, record.satisfied)
    stamps = {record.stamp for record in records if isinstance(record, (Robustness, Bounds))}
    metrics.count("rtamt_samples_total", len(stamps))
    metrics.set("rtamt_lag_seconds", (now - max(record.stamp for record in records)) / 1e9)
