"""The log of a search: a JSON Lines file of evaluations, for inspection and for resuming the search.

The first line describes the search; each further line is one evaluation. A resumed search restarts its
optimizer with the same seed and reads recorded results instead of simulating again, so that it continues
exactly like an uninterrupted one.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.files import write_text
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class Evaluation:
    """One simulation: its point and its result."""

    number: int  # from 0
    point: Mapping[str, float]
    robustness: float
    satisfied: bool
    #: The simulated time in seconds at which the verdict was final and the simulation stopped; None: it ran to its end.
    #: The robustness is then that of the best possible continuation.
    stopped: float | None = None

    def to_json(self) -> str:
        """Return one line; infinities are written as text, since JSON has none."""
        data = asdict(self)
        if not isfinite(self.robustness):
            data["robustness"] = str(self.robustness)
        return json.dumps(data)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Evaluation:
        """Read a line written by :meth:`to_json`."""
        return cls(**{**data, "robustness": float(data["robustness"])})


class Record:
    """A file of evaluations; without a path, kept in memory only."""

    def __init__(self, path: str | os.PathLike[str] | None, about: Mapping[str, Any]) -> None:
        self._path = None if path is None else Path(path)
        self._known: list[Evaluation] = []
        if self._path is None:
            return
        if self._path.exists() and self._path.stat().st_size:
            self._known = _read(self._path, about)
        else:
            self._append(json.dumps({"search": about}))

    def recorded(self, number: int, point: Mapping[str, float]) -> Evaluation | None:
        """Return the evaluation with this number; None if it is not recorded yet."""
        if number >= len(self._known):
            return None
        found = self._known[number]
        if dict(found.point) != dict(point):
            raise UsageError(
                f"'{self._path}' holds another point as evaluation {number}: it was made by another version of "
                f"the optimizer; give the run a new file"
            )
        return found

    def add(self, evaluation: Evaluation) -> None:
        """Add a new evaluation."""
        if self._path is not None and evaluation.number >= len(self._known):
            self._append(evaluation.to_json())

    def _append(self, line: str) -> None:
        assert self._path is not None
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(line + "\n")
        except OSError as error:
            raise UsageError(f"cannot write the record '{self._path}': {error.strerror}") from error


def _read(path: Path, about: Mapping[str, Any]) -> list[Evaluation]:
    try:
        text = path.read_text(encoding="utf-8")
        head, *lines = text.splitlines()
        if not text.endswith("\n"):  # the run was killed while it wrote
            lines = lines[:-1]
            write_text(path, "\n".join((head, *lines)) + "\n")
        before = dict(json.loads(head)["search"])
        known = [Evaluation.from_json(json.loads(line)) for line in lines]
    except (ValueError, KeyError, TypeError, RecursionError, OSError) as error:
        raise UsageError(f"'{path}' is no record of a search; give the run a new file") from error
    now = json.loads(json.dumps(about))
    for key in now:
        if before.get(key) != now[key]:
            raise UsageError(
                f"'{path}' records a search with another {key}: {before.get(key)!r} there, {now[key]!r} now; "
                f"give the run a new file"
            )
    return known
