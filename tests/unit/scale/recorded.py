"""Recordings, a suite and jobs that the tests of engines share."""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING, Any

import numpy as np

import rtamt
from rtamt.scale.job import Job

if TYPE_CHECKING:
    from pathlib import Path

    from rtamt.fleet.verdict_table import VerdictTable

TEXT = """
    require LOW: always(x <= 4)
    require RESPONSE: always(x >= 2 -> eventually[0:1](y >= 2))
    require RATIO: always(y / x >= -50)
"""


def suite(**settings: Any) -> rtamt.Suite:
    return rtamt.Suite(rtamt.parse(TEXT, period="500ms"), **settings)


def columns(number: int, samples: int = 20) -> dict[str, Any]:
    random = np.random.default_rng(number)
    return {
        "time": np.arange(samples) * 0.5,
        "x": random.normal(2, 1.5, samples).round(3),
        "y": random.normal(2, 1.5, samples).round(3),
    }


def write_csv(path: Path, number: int) -> None:
    data = columns(number)
    rows = zip(*(column.tolist() for column in data.values()), strict=True)
    path.write_text("time,x,y\n" + "".join(f"{t},{x},{y}\n" for t, x, y in rows))


def expected(number: int, name: str) -> Any:
    return suite().evaluate(columns(number), recording=name).rows


class DeadlyJob(Job):
    """A job whose process dies at some recordings, as one that runs out of memory."""

    def table(self, path: str) -> VerdictTable:
        if "deadly" in path:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().table(path)

    def __reduce__(self) -> tuple[Any, ...]:
        return deadly_job, ()


def deadly_job() -> DeadlyJob:
    return DeadlyJob(suite())


def rows(tables):
    """Return the rows of tables, one after another."""
    return [row for table in tables for row in table]
