"""A Parquet recording of 10 GB through `rtamt.check_stream`, row group by row group: memory stays flat.

    python benchmarks/stream.py [GB]

The file on disk holds a hundredth of that; it is read over and over, each time with later timestamps.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

import rtamt

if TYPE_CHECKING:
    from collections.abc import Iterator

ROWS, GROUP = 4_000_000, 100_000
BYTES_A_ROW = 3 * 8  # a stamp and two values, as doubles
FORMULA = "always((req >= 3) -> eventually[0:5](gnt >= 3))"


def peak() -> float:
    """Return the largest memory of this process so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write(path: Path) -> None:
    """Write four million samples, 10 ms apart, in groups of a hundred thousand."""
    random = np.random.default_rng(1)
    schema = pa.schema([("time", pa.float64()), ("req", pa.float64()), ("gnt", pa.float64())])
    with parquet.ParquetWriter(path, schema, compression="snappy") as writer:
        for begin in range(0, ROWS, GROUP):
            times = np.arange(begin, begin + GROUP) / 100
            columns = [times, random.normal(size=GROUP), random.normal(3, 1, size=GROUP)]
            writer.write_table(pa.table(columns, schema=schema), row_group_size=GROUP)


def over_and_over(path: Path, gigabytes: float, spec: rtamt.Specification) -> Iterator[dict[str, Any]]:
    """Yield the chunks of the file until so much has been read, and print where we are."""
    begin, read, mark = time.process_time(), 0, 0.01
    names = spec.input_names
    rounds = 0
    while True:
        for chunk in rtamt.scan(path, columns=names):
            data = chunk.on_one_time_base(names)
            yield {**data, "time": data["time"] + rounds * ROWS / 100}
            read += len(data["time"])
            done = read * BYTES_A_ROW / 1e9
            if done >= mark or done >= gigabytes:
                spent = time.process_time() - begin
                print(
                    f"{done:6.2f} GB, {read:12,} samples: {spent / read * 1e9:5.1f} ns of processor "
                    f"time a sample, peak of the process {peak():6.1f} MiB",
                    flush=True,
                )
                mark *= 10
            if done >= gigabytes:
                return
        rounds += 1


def main() -> None:
    """Check the requirement over the whole stream."""
    gigabytes = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    spec = rtamt.parse(FORMULA, period="10ms")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log.parquet")
        write(path)
        print(f"{FORMULA}: {path.stat().st_size / 1e6:.0f} MB on disk, read over and over")
        result = rtamt.check_stream(spec, over_and_over(path, gigabytes, spec))
    print(f"robustness {result.robustness:.6g}, first violation {result.first_violation}")


if __name__ == "__main__":
    main()
