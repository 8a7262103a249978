"""A stream whose variables arrive at any time, sampled by the rule ``sample 100ms hold`` of the specification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import STDIN
from rtamt.errors import TraceError

if TYPE_CHECKING:
    from rtamt.cli.delayed_feeds import EventFeed, SampleFeed
    from rtamt.cli.early_feeds import CausationFeed, EagerFeed, IntervalFeed, StartFeed
    from rtamt.signals.sampling import HeldSampler


class HeldFeed:
    """Passes resampled samples of the stream to another feed."""

    def __init__(
        self,
        feed: SampleFeed | EventFeed | EagerFeed | IntervalFeed | StartFeed | CausationFeed,
        sampler: HeldSampler,
    ) -> None:
        self.monitor = feed.monitor
        self._feed = feed
        self._sampler = sampler

    def take(self, time: Any, values: dict[str, float], line: int) -> str:
        """Take values of some variables; return what is wrong with them, if anything is."""
        if time is None:
            return f"{STDIN}, line {line}: values that are held need their time"
        try:
            for timestamp, sample in self._sampler.take(time, values):
                problem = self._feed.take(timestamp, sample, line)
                if problem:
                    return problem
        except TraceError as error:
            return f"{STDIN}, line {line}: {error}"
        return ""

    def finish(self) -> str:
        """End the trace; return what is wrong with the last samples, if anything is."""
        try:
            for timestamp, sample in self._sampler.finish():
                problem = self._feed.take(timestamp, sample, 0)
                if problem:
                    return problem
        except TraceError as error:
            return f"{STDIN}: {error}"
        if self._feed.monitor.samples:
            self._feed.finish()
        return ""
