"""Many requirements on many recordings: ``python benchmarks/recordings.py [RECORDINGS] [REQUIREMENTS] [ENGINE ...]``.

Writes synthetic recordings in Parquet (1 000 samples of six signals at 10 Hz; one of them is damaged), checks them with
each engine (by default all: local, ray and spark), and compares the tables. The processor time of one core is split
into arithmetic (the programs alone), the suite (data checks and rows added) and reading. The other columns of the
engines are wall times: on a busy machine they show that the engine runs, and nothing else.
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import rtamt
from rtamt.scale.engines import ENGINES, check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.fleet.verdict_table import VerdictTable
    from rtamt.scale.recordings import Recording

SAMPLES = 1000
SIGNALS = ("speed", "brake", "distance", "yaw", "voltage", "temperature")


def write_recordings(folder: Path, count: int) -> None:
    """Write the recordings; the last one is damaged."""
    random = np.random.default_rng(19)
    time_column = np.arange(SAMPLES) * 0.1
    for number in range(count):
        walks = {name: random.normal(0, 1, SAMPLES).cumsum() for name in SIGNALS}
        pq.write_table(pa.table({"time": time_column, **walks}), folder / f"{number:05}.parquet")
    path = folder / f"{count - 1:05}.parquet"
    path.write_bytes(path.read_bytes()[:1000])


def specifications(count: int) -> dict[str, rtamt.Specification]:
    """Return requirements of three kinds: an invariant, a response in time, and a bounded history."""
    texts = {}
    for number in range(count):
        x, y = SIGNALS[number % 6], SIGNALS[(number // 6) % 6]
        limit, bound = number % 40 - 20, number % 9 + 1
        texts[f"R{number}"] = (
            f"always({x} <= {limit + 40})",
            f"always({x} >= {limit} -> eventually[0:{bound}]({y} >= {limit - 30}))",
            f"always(historically[0:{bound}]({x} <= {limit}) -> {y} <= {limit + 50})",
        )[number % 3]
    return {name: rtamt.parse(text, period="100ms") for name, text in texts.items()}


def processor_time(work: Callable[[], object]) -> float:
    """Return the seconds of one core that some work takes."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def print_costs(job: Job, recordings: list[Recording]) -> None:
    """Print what a verdict costs on one core, and how much of it is arithmetic."""
    suite, some = job.suite, recordings[: min(200, len(recordings) - 1)]
    traces = [rtamt.read(recording.path) for recording in some]
    (group,) = suite._groups
    ready = [group.way.recording(trace) for trace in traces]
    programs = group.programs(ready[0].step)
    list(programs.evaluate(ready[0]))  # loads the programs
    verdicts = len(some) * len(suite)
    parts = {
        "arithmetic": lambda: [list(programs.evaluate(each)) for each in ready],
        "suite": lambda: [suite.evaluate(each) for each in traces],
        "suite and reading": lambda: [job.table(recording.path) for recording in some],
    }
    times = {name: [processor_time(work) for _ in range(3)] for name, work in parts.items()}
    least = {name: min(each) for name, each in times.items()}
    for name, seconds in least.items():
        ratio = seconds / least["arithmetic"]
        print(f"{name:18} {seconds / verdicts * 1e6:7.2f} us a verdict   {ratio:5.2f} x arithmetic")
    seconds = [
        processor_time(lambda: [each.evaluate(traces[0]).satisfied for each in specs]) for _ in range(3)
    ]
    print(f"{'evaluate, alone':18} {min(seconds) / len(suite) * 1e6:7.2f} us a verdict")


def run(engine: str, job: Job, recordings: list[Recording], jobs: int | None) -> list[VerdictTable]:
    """Check all recordings, and print how long that took."""
    begin, before = time.perf_counter(), _children()
    own = time.process_time()
    tables = list(check_recordings(job, recordings, engine=engine, jobs=jobs))
    own = time.process_time() - own
    cores = own + _children() - before
    label = engine if jobs is None else f"{engine}, {jobs} process{'es' * (jobs > 1)}"
    wall = time.perf_counter() - begin
    print(f"{label:18} {wall:8.1f} s wall, {cores:7.1f} s of processor time seen, {own:.1f} s here")
    return tables


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    given = sys.argv[1:]
    count, requirements = (int(text) for text in (given + ["2000", "100"][len(given) :])[:2])
    specs = list(specifications(requirements).values())
    with tempfile.TemporaryDirectory() as name:
        write_recordings(Path(name), count)
        job = Job(rtamt.Suite(specifications(requirements)))
        recordings = recordings_of([name])
        print(
            f"{count} recordings of {SAMPLES} samples, {requirements} requirements; {os.cpu_count()} cores, "
            f"load {os.getloadavg()[0]:.1f}"
        )
        print_costs(job, recordings)
        known = None
        for engine in given[2:] or ENGINES:
            for jobs in (1, 2) if engine == "local" else (None,):
                tables = run(engine, job, recordings, jobs)
                known = known or tables
                assert tables == known, f"{engine} has another table"
        errors = sum(row.error is not None for table in known for row in table)
        print(f"the same table everywhere: {sum(map(len, known))} verdicts, {errors} of them errors")
