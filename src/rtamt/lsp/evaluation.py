"""The process that reads recordings for the server: one request as JSON in, one answer as JSON out.

It is a separate process, so that the server can end it, and so that a large recording does not grow the server.
"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError
from rtamt.lazy.dataclasses import replace
from rtamt.readers.read import read
from rtamt.specification_loader import parse

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """Return the columns of a recording, or the verdict of each requirement of a text on it.

    ``request``: ``recording``, a path; for verdicts also ``text``, ``folder``, ``period`` and ``time``. A mistake in
    the recording is an answer with ``error``.
    """
    try:
        if "text" not in request:
            return {"columns": list(read(request["recording"]).names)}
        spec = parse(
            request["text"],
            folder=request.get("folder"),
            period=request.get("period") or None,
            time=request.get("time") or "discrete",
        )
        trace = read(request["recording"], types=spec.types)
        return {"rows": list(_rows(spec, trace))}
    except StlError as error:
        return {"error": _sentence(error)}
    except MemoryError:
        return {"error": "not enough memory for the recording"}


def _rows(spec: Specification, trace: Trace) -> Iterator[dict[str, Any]]:
    unchecked = spec.unchecked(trace)
    document = spec.document
    for requirement in document.requirements:
        row: dict[str, Any] = {"name": requirement.name}
        if requirement.name in unchecked:
            yield row | {"verdict": "unchecked", "reason": unchecked[requirement.name]}
            continue
        try:
            one = replace(spec, document=document.select(requirement.name))
            result = one.evaluate(trace)
            row["verdict"] = "satisfied" if result.satisfied else "violated"
        except StlError as error:
            yield row | {"verdict": "error", "reason": _sentence(error)}
            continue
        known = result.interval
        if known.lower == known.upper:  # no samples are missing that decide the robustness
            row["robustness"] = repr(float(known.lower))
        yield row


def _sentence(error: StlError) -> str:
    return str(error).splitlines()[0]


def main() -> None:
    """Answer one request on the standard streams."""
    request = json.load(sys.stdin)
    answers, sys.stdout = sys.stdout, sys.stderr  # what a library prints is no answer
    json.dump(answer(request), answers)


if __name__ == "__main__":
    main()
