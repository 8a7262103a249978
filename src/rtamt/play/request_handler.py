"""Dispatch requests by kind: a message in, data out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError
from rtamt.lazy.dataclasses import replace
from rtamt.play.evaluation import Sources, evaluate_request, redraw
from rtamt.play.messages import MessageError, Request
from rtamt.play.online import known_at, redraw_replay, replay_request
from rtamt.play.recordings import File, Recordings

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The kinds of requests to a worker.
KINDS = ("evaluate", "redraw", "replay", "redraw_replay", "cursor", "find_trace", "recording")
_ANSWERS = {
    "evaluate": evaluate_request,
    "redraw": redraw,
    "replay": replay_request,
    "redraw_replay": redraw_replay,
    "cursor": known_at,
}


class RequestHandler:
    """Answer messages one by one; the only state is the recordings and the last result.

    >>> handler = RequestHandler()
    >>> answer = handler.answer("evaluate", {"text": "always(x >= 3)", "time": "discrete", "duration": 2,
    ...     "signals": {"x": {"points": [[0, 5], [2, 1]], "hold": False}}})
    >>> answer["verdict"], answer["interval"], answer["first"]
    ('violated', [-2.0, -2.0], 2.0)
    """

    def __init__(self, folder: str | None = None) -> None:
        self._sources = Sources(Recordings(), folder=folder)

    def answer(
        self, kind: str, message: Mapping[str, Any], file: Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        """Answer one request; raises :class:`MessageError` if it is malformed.

        ``file``: the recording that the server has found for the message.
        """
        known = None if file is None else File(file["number"], file["path"], file["name"])
        if kind == "recording":
            return self._recording(known)
        sources = replace(self._sources, file=known)
        try:
            request = Request.of(message)
        except MessageError:
            raise
        except StlError as error:
            return {"error": {"message": str(error), "start": None, "end": None}}
        if kind in _ANSWERS:
            return _ANSWERS[kind](request, sources)
        if kind == "find_trace":
            from rtamt.play.witnesses import WANTED, find_trace

            wanted = message.get("wanted")
            if not isinstance(wanted, str) or wanted not in WANTED:
                raise MessageError(f"'wanted' must be {' or '.join(WANTED)}")
            return find_trace(request, wanted, sources)
        raise MessageError(f"there is no request '{kind}'; requests: {', '.join(KINDS)}")

    def _recording(self, file: File | None) -> dict[str, Any]:
        if file is None:
            raise MessageError("there is no recording of that number")
        try:
            return {"error": None, **self._sources.recordings.summary(file)}
        except StlError as error:
            return {"error": {"message": file.without_folder(str(error)), "start": None, "end": None}}
