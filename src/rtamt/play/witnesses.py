"""A witness or a counterexample of a requirement, as signals to draw."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.analysis import satisfiable, valid
from rtamt.errors import StlError, UsageError
from rtamt.play.evaluation import error_as_data, parse_request

if TYPE_CHECKING:
    from rtamt.play.evaluation import Sources
    from rtamt.play.messages import Request

#: What can be requested, and the query that answers it.
WANTED = {"witness": satisfiable, "counterexample": valid}

#: The longest trace, in samples, and the time limit of a query, in seconds.
_SAMPLES, _LIMIT = 100, 8.0


def find_trace(request: Request, wanted: Any, sources: Sources) -> dict[str, Any]:
    """Look for a trace that satisfies a requirement (``"witness"``), or violates it (``"counterexample"``)."""
    if wanted not in WANTED:
        raise UsageError(f"'wanted' must be {' or '.join(WANTED)}")
    try:
        answer = WANTED[wanted](parse_request(request, sources), samples=_SAMPLES, limit=_LIMIT)
    except StlError as error:
        return {"error": error_as_data(error, sources)}
    witness = answer.witness
    if witness is None:
        return {"error": None, "sentence": answer.sentence, "signals": None}
    if not witness.confirmed:
        return {
            "error": None,
            "sentence": "the solver found no trace that the engine confirms",
            "signals": None,
        }
    times = [float(k * witness.period) for k in range(witness.samples)]
    return {
        "error": None,
        "sentence": answer.sentence,
        "period": float(witness.period),
        "duration": times[-1],
        "signals": {
            name: {"hold": True, "points": _changes(times, column.tolist())}
            for name, column in witness.columns.items()
        },
    }


def _changes(times: list[float], values: list[float]) -> list[list[float]]:
    """Return the points of a held signal: the first, and each with another value than the one before.

    >>> _changes([0.0, 1.0, 2.0, 3.0], [5.0, 5.0, 2.0, 2.0])
    [[0.0, 5.0], [2.0, 2.0]]
    """
    points = zip(times, values, [None, *values], strict=False)
    return [[time, value] for time, value, before in points if value != before]
