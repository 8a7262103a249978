"""Run simulations in batches, in one or several processes; record and count them, and stop the search."""

from __future__ import annotations

import pickle
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

from rtamt.errors import UsageError, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from concurrent.futures import Executor
    from types import TracebackType

    from rtamt.search.log import Evaluation, Record
    from rtamt.search.problem import Problem


class Enough(Exception):  # noqa: N818 - not an error: it ends the optimizer
    """The budget is exhausted, or a violation is found."""


class Runs(AbstractContextManager["Runs"]):
    """Runs a problem at a sequence of points; ``made`` contains the evaluations in order.

    ``stop``: end at the first violation. ``whole``: run every simulation to its end.
    """

    def __init__(
        self,
        problem: Problem,
        record: Record,
        budget: int,
        *,
        workers: int = 1,
        stop: bool = False,
        whole: bool = False,
        progress: Callable[[Evaluation], None] | None = None,
    ) -> None:
        count("the budget", budget)
        count("the number of workers", workers)
        self.made: list[Evaluation] = []
        self._problem = problem
        self._record = record
        self._budget = budget
        self._stop = stop
        self._whole = whole
        self._progress = progress
        self._pickled = _pickle(problem) if workers > 1 else b""
        self._pool: Executor | None = ProcessPoolExecutor(workers) if workers > 1 else None

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def batch(self, points: Sequence[Mapping[str, float]]) -> list[Evaluation]:
        """Evaluate at these points, in order; raise :class:`Enough` at the end of the search."""
        first = len(self.made)
        points = points[: self._budget - first]
        known = [self._record.recorded(first + k, point) for k, point in enumerate(points)]
        ahead = iter(self._run_jobs([(first + k, p) for k, p in enumerate(points) if known[k] is None]))
        found = []
        for evaluation in known:
            new = next(ahead) if evaluation is None else evaluation
            self._record.add(new)
            self.made.append(new)
            found.append(new)
            if self._progress is not None:
                self._progress(new)
            if (self._stop and not new.satisfied) or len(self.made) == self._budget:
                raise Enough
        return found

    def _run_jobs(self, jobs: Sequence[tuple[int, Mapping[str, float]]]) -> Iterable[Evaluation]:
        if self._pool is None or len(jobs) < 2:
            return (self._problem.run(point, number, whole=self._whole) for number, point in jobs)
        futures = [self._pool.submit(_simulate, self._pickled, *job, self._whole) for job in jobs]
        return (future.result() for future in futures)


def _simulate(problem: bytes, number: int, point: Mapping[str, float], whole: bool) -> Evaluation:
    """Run one simulation in a worker."""
    evaluation: Evaluation = pickle.loads(problem).run(point, number, whole=whole)  # noqa: S301 - our own bytes, from our own process
    return evaluation


def _pickle(problem: Problem) -> bytes:
    try:
        return pickle.dumps(problem)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise UsageError(
            f"the plant cannot be sent to several workers ({error}): make it a function of a module, or use one worker"
        ) from error


def count(what: str, number: object) -> None:
    """Raise :class:`UsageError` unless a value is a valid count."""
    if not isinstance(number, int) or number < 1:
        raise UsageError(f"{what} is {shown(number)}; give a whole number, 1 or more")
