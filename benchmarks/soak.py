"""A soak test: 10^8 samples, and hours of dense events, one update each; `make soak`, some minutes.

Two properties must hold to the end: memory stays constant, and every value equals that of an
offline evaluation. The offline evaluation runs piece by piece, each with as much context as the formula
can read, so that its memory is bounded, too.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FORMULA = (
    "historically[0:2000]((req >= 3) -> eventually[0:50](gnt >= 3)) "
    "or ((req <= 2) since[0:300] (gnt >= 4)) or ((gnt <= 2) until[10:200] (req >= 1))"
)
BEHIND, AHEAD = 2300, 200  # samples that the formula sees before and after an instant, at most
PIECE = 200_000

# The same in dense time, in milliseconds: about one event a millisecond.
DENSE = FORMULA.translate({ord("]"): "ms]"})
BEHIND_NS, AHEAD_NS = BEHIND * 10**6, AHEAD * 10**6
DENSE_PIECE = 100_000

#: What the process may grow by after its first pieces: room that Python's allocator keeps.
GROWTH = 32 * 2**20


class Watch:
    """Reports the progress, time and memory of a run."""

    def __init__(self, what: str, total: int) -> None:
        self.what, self.total = what, total
        self.began = time.perf_counter()
        self.in_updates = 0.0
        self.settled = 0
        self.pieces = 0

    def piece(self, done: int, memory: int) -> None:
        """Report after a piece; stop if the process has grown since the first ten."""
        now = resident()
        self.pieces += 1
        if self.pieces == 10:
            self.settled = now
        if self.settled and now > self.settled + GROWTH:
            raise SystemExit(f"\n{self.what}: memory grew from {self.settled >> 20} to {now >> 20} MiB")
        share = done / self.total
        left = (time.perf_counter() - self.began) * (1 / share - 1)
        sys.stderr.write(
            f"\r{self.what}: {share:6.1%}, {left:4.0f} s left, process {now >> 20} MiB, monitor {memory >> 10} KiB  "
        )
        sys.stderr.flush()

    def finish(self, done: int, memory: int, what: str) -> None:
        """Report the whole run."""
        sys.stderr.write("\r" + " " * 100 + "\r")
        sys.stdout.write(
            f"{self.what}: {done:,} {what} in {time.perf_counter() - self.began:.0f} s, "
            f"{self.in_updates / done * 1e9:.0f} ns an update; every value equal to offline; "
            f"monitor {memory / 1024:.0f} KiB, process {self.settled / 2**20:.0f} MiB after ten "
            f"of {self.pieces} pieces and {resident() / 2**20:.0f} MiB at the end\n"
        )


def resident() -> int:
    """Return the bytes of the process that are in memory."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize()


def signals(k: int, n: int) -> tuple[Array, Array]:
    """Return piece ``k`` of a request and a grant: mostly quiet, small steps, the same in every run."""
    draw = np.random.default_rng([7, k])
    req = np.where(draw.random(n) < 0.001, 6.0, 0.0) + draw.integers(0, 8, n) / 4
    gnt = np.where(draw.random(n) < 0.03, 6.0, 0.0) + draw.integers(0, 8, n) / 4
    return req, gnt


def discrete(total: int) -> None:
    """Watch ``total`` samples one by one."""
    spec = rtamt.parse(FORMULA)
    monitor = spec.monitor()
    late = int(monitor.horizon)
    watch = Watch("discrete time", total)
    before: tuple[Array, Array] = (np.empty(0), np.empty(0))
    memory = monitor.memory
    for k in range(total // PIECE):
        req, gnt = signals(k, PIECE)
        rows = list(zip(req.tolist(), gnt.tolist(), strict=True))
        begin = time.perf_counter()
        told = [monitor.step(*row) for row in rows]
        watch.in_updates += time.perf_counter() - begin
        if k == 0:
            expect(told[:late] == [None] * late, "nothing is reported before the horizon")
            told = told[late:]
        # Samples from `first` on; these updates reported the values of [low, high).
        whole = [np.concatenate(parts) for parts in zip(before, (req, gnt), strict=True)]
        first = k * PIECE - len(before[0])
        low, high = max(0, k * PIECE - late), (k + 1) * PIECE - late
        offline = spec.evaluate({"req": whole[0], "gnt": whole[1]}, period=1).signal.values
        expect(np.array_equal(told, offline[low - first : high - first]), f"piece {k} differs from offline")
        before = (whole[0][-BEHIND - late :], whole[1][-BEHIND - late :])
        expect(monitor.memory == memory, "the monitor's memory changed")
        watch.piece((k + 1) * PIECE, monitor.memory)
    watch.finish(monitor.samples, monitor.memory, "samples")


def dense(hours: float) -> None:
    """Watch ``hours`` of events, about one a millisecond, of one variable after another."""
    spec = rtamt.parse(DENSE, time="dense")
    monitor = spec.monitor(time="dense")
    last = int(hours * 3600 * 10**9)
    watch = Watch("dense time", last)
    kept: dict[str, tuple[Any, Any]] = {}
    known, most, updates, now = 0, 0, 0, -1
    carried: tuple[Any, Any] = (np.empty(0, np.int64), np.empty(0))
    for k, (timestamps, columns) in enumerate(events(last)):
        told_times: list[float] = []
        told_values: list[float] = []
        begin = time.perf_counter()
        for t, name, value in columns:
            signal = monitor.update(t, **{name: value})
            if len(signal):
                told_times += signal.times.tolist()
                told_values += signal.values.tolist()
        watch.in_updates += time.perf_counter() - begin
        updates += len(columns)
        now = int(timestamps["req"][0][-1])
        for name, (times, values) in timestamps.items():
            old = kept.get(name, (np.empty(0, np.int64), np.empty(0)))
            kept[name] = (np.concatenate((old[0], times)), np.concatenate((old[1], values)))
        until = round(told_times[-1] * 1e9)
        offline = spec.evaluate(kept, time_unit="ns").signal
        online_times = np.concatenate((carried[0], np.rint(np.array(told_times) * 1e9).astype(np.int64)))
        online_values = np.concatenate((carried[1], told_values))
        wanted = changes(offline.times, offline.values, known, until)
        got = changes(online_times, online_values, known, until)
        expect(np.array_equal(got, wanted), f"piece {k} differs from offline")
        carried = (online_times[-1:], online_values[-1:])
        known = until
        for name, (times, values) in kept.items():
            cut = max(0, int(np.searchsorted(times, known - BEHIND_NS)) - 1)
            kept[name] = (times[cut:], values[cut:])
        most = max(most, monitor.memory)
        watch.piece(now, monitor.memory)
    watch.finish(updates, most, f"events over {hours:g} hours")


def events(last: int) -> Iterator[tuple[dict[str, tuple[Any, Array]], list[tuple[float, str, float]]]]:
    """Yield pieces of events up to ``last`` ns: arrays a variable, and all in the order of time."""
    begin, k = 0, 0
    while begin < last:
        draw = np.random.default_rng([11, k])
        times = begin + np.cumsum(draw.integers(100_000, 1_900_000, DENSE_PIECE))
        pair = signals(k, DENSE_PIECE)
        turn = draw.integers(0, 2, DENSE_PIECE) == 0
        turn[0], turn[1], turn[-2], turn[-1] = True, False, False, True
        timestamps = {
            name: (times[mine], values[mine])
            for name, mine, values in (("req", turn, pair[0]), ("gnt", ~turn, pair[1]))
        }
        names = np.where(turn, "req", "gnt").tolist()
        values = np.where(turn, pair[0], pair[1]).tolist()
        yield timestamps, list(zip((times / 1e9).tolist(), names, values, strict=True))
        begin, k = int(times[-1]), k + 1


def changes(times: Any, values: Any, begin: int, end: int) -> Any:
    """Return the changes of a step function in (begin, end], as columns of time and value."""
    keep = np.concatenate(([True], values[1:] != values[:-1])) if len(values) else np.empty(0, bool)
    inside = keep & (times > begin) & (times <= end)
    return np.array([times[inside].astype(float), values[inside]])


def expect(holds: bool, what: str) -> None:
    """Stop if a condition does not hold."""
    if not holds:
        raise SystemExit(f"\nsoak: {what}")


def main() -> None:
    """Run both watches."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--samples", type=float, default=1e8, help="in discrete time (default: 1e8)")
    options.add_argument("--hours", type=float, default=4, help="in dense time (default: 4)")
    given = options.parse_args()
    if given.samples:
        discrete(int(given.samples))
    if given.hours:
        dense(given.hours)


if __name__ == "__main__":
    main()
