"""The worker process: a JSON line in, a status and a JSON line out, until the end of its input.

It is a separate process, so that the server can abort a request that takes too long.
"""

from __future__ import annotations

import json
import sys
from typing import Any, BinaryIO

from rtamt.errors import StlError
from rtamt.play.messages import MessageError
from rtamt.play.request_handler import RequestHandler


def reply(handler: RequestHandler, line: bytes) -> bytes:
    r"""Answer one line: ``{"kind", "message", "file"}``; the answer begins with an HTTP status.

    >>> reply(RequestHandler(), b'{"kind": "evaluate", "message": {"text": 3}}')
    b'400 {"sentence": "\'text\' must be a text"}'
    """
    try:
        asked = json.loads(line)
        return _line(200, handler.answer(asked["kind"], asked["message"], asked.get("file")))
    except MessageError as error:
        return _line(400, {"sentence": str(error)})
    except StlError as error:
        return _line(200, {"error": {"message": str(error), "start": None, "end": None}})
    except MemoryError:
        return _failure("not enough memory: are the bounds of a window as large as they should be?")
    except RecursionError:
        return _failure("the formula is nested too deeply")
    except Exception as error:  # noqa: BLE001 - a bug here; the page reports it and continues
        return _failure(f"internal error, please report it: {type(error).__name__}: {error}")


def _failure(sentence: str) -> bytes:
    return _line(200, {"error": {"message": sentence, "start": None, "end": None}})


def _line(status: int, data: dict[str, Any]) -> bytes:
    return f"{status} {json.dumps(data, allow_nan=False)}".encode()


def serve(given: BinaryIO, answers: BinaryIO, folder: str | None) -> None:
    """Answer every line."""
    handler = RequestHandler(folder)
    for line in given:
        answers.write(reply(handler, line) + b"\n")
        answers.flush()


def main() -> None:
    """Serve on the standard streams; ``sys.argv[1]``: the folder of imported files, if there is one."""
    answers = sys.stdout.buffer
    sys.stdout = sys.stderr  # what a library prints is no answer
    serve(sys.stdin.buffer, answers, sys.argv[1] if len(sys.argv) > 1 else None)


if __name__ == "__main__":
    main()
