"""The application: the page, its files, and the answers of the workers.

Every address begins with the token of the server. Requests are accepted under the server's own name only, so that
no other page can reach it, not even by a name that leads to this machine.
"""

from __future__ import annotations

import importlib.util
import json
import os
import secrets
from contextlib import suppress
from importlib.resources import files
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from rtamt.extras import library
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.play.messages import MOST_BYTES
from rtamt.play.request_handler import KINDS
from rtamt.play.vocabulary import vocabulary
from rtamt.readers.formats import SUFFIXES

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from rtamt.play.worker_pool import WorkerPool

    Scope = Mapping[str, Any]
    Receive = Callable[[], Awaitable[Any]]
    Send = Callable[[Any], Awaitable[None]]

#: The largest recording that the page may send, in bytes, and how many files are kept.
MOST_UPLOAD, _MOST_FILES = 512_000_000, 16
#: The largest recording that a link contains.
_MOST_IN_LINK = 400_000

_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


@dataclass(frozen=True, slots=True)
class Given:
    """The arguments of the command line: the text of a specification, settings, and a recording."""

    text: str = ""
    name: str = ""
    time: str = "discrete"
    period: str = ""
    recording: str | None = None


@dataclass(slots=True)
class Place:
    """A server: its token, its names with the port, the folder of its files, and its workers."""

    token: str
    hosts: tuple[str, ...]
    folder: str
    workers: WorkerPool
    given: Given
    files: dict[int, dict[str, Any]] = field(default_factory=dict)
    newest: int = 0

    def add(self, path: str, name: str, *, ours: bool) -> dict[str, Any]:
        """Register a recording under a new number; the oldest of our own files is deleted."""
        self.newest += 1
        self.files[self.newest] = {"number": self.newest, "path": path, "name": name, "ours": ours}
        own = [number for number, each in self.files.items() if each["ours"]]
        for number in own[:-_MOST_FILES]:
            os.unlink(self.files.pop(number)["path"])
        return self.files[self.newest]


def application(place: Place) -> Any:
    """Return the ASGI application of a server; raises :class:`UsageError` where starlette is not installed."""
    starlette = {
        name: library(f"starlette.{name}", "rtamt play", "play")
        for name in ("applications", "requests", "responses", "routing")
    }
    response, route = starlette["responses"].Response, starlette["routing"].Route

    def answer(status: int, body: bytes, kind: str = "application/json") -> Any:
        return response(body, status_code=status, media_type=kind)

    def refuse(status: int, sentence: str) -> Any:
        return answer(status, json.dumps({"sentence": sentence}).encode())

    async def page(request: Any) -> Any:
        name = request.path_params.get("name", "index.html")
        found = _page_file(name)
        if found is None:
            return refuse(404, f"there is no file '{name}'")
        return answer(200, found, _TYPES[os.path.splitext(name)[1]])

    async def start(_request: Any) -> Any:
        return answer(200, json.dumps(await _start(place)).encode())

    async def ask(request: Any) -> Any:
        kind = request.path_params["kind"]
        if kind not in KINDS:
            return refuse(404, f"there is no request '{kind}'")
        body = await _body(request, MOST_BYTES)
        if body is None:
            return refuse(413, f"the request has more than {MOST_BYTES} bytes")
        message = _message(body)
        if message is None:
            return refuse(400, "the request must be a JSON object")
        file = place.files.get(message["recording"]) if type(message.get("recording")) is int else None
        return answer(*await place.workers.ask(kind, message, file))

    async def cancel(_request: Any) -> Any:
        await place.workers.cancel()
        return answer(200, b"{}")

    async def upload(request: Any) -> Any:
        name = os.path.basename(unquote(request.headers.get("x-name", ""))).strip()[:200]
        suffix = os.path.splitext(name)[1].lower()
        if suffix not in SUFFIXES:
            return refuse(400, f"'{name}' is no recording: its name ends in none of {', '.join(SUFFIXES)}")
        path = os.path.join(place.folder, f"{place.newest + 1}-{secrets.token_hex(4)}{suffix}")
        whole = False
        try:
            with open(path, "xb") as file:
                whole = await _body(request, MOST_UPLOAD, file.write) is not None
        finally:
            if not whole:
                os.unlink(path)
        if not whole:
            return refuse(413, f"'{name}' has more than {MOST_UPLOAD} bytes; give it on the command line")
        found = place.add(path, name, ours=True)
        return answer(*await place.workers.ask("recording", {}, found))

    async def file(request: Any) -> Any:
        found = place.files.get(request.path_params["number"])
        if found is None:
            return refuse(404, "there is no recording of that number")
        if not os.path.isfile(found["path"]) or os.path.getsize(found["path"]) > _MOST_IN_LINK:
            return refuse(413, f"'{found['name']}' is too large for a link")
        with open(found["path"], "rb") as opened:
            return answer(200, opened.read(), "application/octet-stream")

    post = {"methods": ["POST"]}
    app = starlette["applications"].Starlette(
        routes=[
            route("/{token}/", page),
            route("/{token}/page/{name}", page),
            route("/{token}/start", start, **post),
            route("/{token}/ask/{kind}", ask, **post),
            route("/{token}/cancel", cancel, **post),
            route("/{token}/upload", upload, **post),
            route("/{token}/file/{number:int}", file),
        ]
    )
    return Guard(app, place, starlette["requests"].ClientDisconnect)


class Guard:
    """Passes on requests that bring the token, under the name of the server, from its own page."""

    def __init__(self, app: Any, place: Place, gone: type[Exception]) -> None:
        self._app = app
        self._place = place
        self._gone = gone

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request; see the ASGI specification."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        wrong = "it is no HTTP request" if scope["type"] != "http" else self._wrong(scope)

        async def with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                extra = [(name.lower().encode(), value.encode()) for name, value in _HEADERS.items()]
                message = {**message, "headers": [*message["headers"], *extra]}
            await send(message)

        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
        elif wrong:
            body = f"{wrong}\n".encode()
            headers = [(b"content-type", b"text/plain; charset=utf-8")]
            await with_headers({"type": "http.response.start", "status": 403, "headers": headers})
            await send({"type": "http.response.body", "body": body})
        else:
            # A client may leave before the end of its request, such as a page that is closed during an upload.
            with suppress(self._gone):
                await self._app(scope, receive, with_headers)

    def _wrong(self, scope: Scope) -> str:
        """Return why a request is refused, in one sentence; "" if it is not."""
        headers = {name: value.decode("latin-1") for name, value in scope["headers"]}
        host = headers.get(b"host", "")
        if host not in self._place.hosts:
            return "this server answers under its own address only"
        token = scope["path"].split("/")[1]
        if not secrets.compare_digest(token.encode(), self._place.token.encode()):
            return "the address lacks the token: open the address that 'rtamt play' has printed"
        if scope["method"] not in {"GET", "HEAD"} and headers.get(b"origin") != f"http://{host}":
            return "this server answers its own page only"
        if headers.get(b"sec-fetch-site", "none") not in {"none", "same-origin"}:
            return "this server answers its own page only"
        return ""


async def _start(place: Place) -> dict[str, Any]:
    """Return the initial data of the page."""
    import rtamt

    given, recording, complaint = place.given, None, ""
    first = next(iter(place.files.values()), None)
    if given.recording is not None and first is not None:
        found = json.loads((await place.workers.ask("recording", {}, first))[1])
        if found["error"]:
            complaint = found["error"]["message"]
        else:
            recording = found
    return {
        "version": rtamt.__version__,
        "text": given.text,
        "name": given.name,
        "time": given.time,
        "period": given.period,
        "recording": recording,
        "complaint": complaint,
        "vocabulary": vocabulary(),
        "suffixes": list(SUFFIXES),
        "analysis": importlib.util.find_spec("z3") is not None,
        "mostInLink": _MOST_IN_LINK,
    }


def _page_file(name: str) -> bytes | None:
    """Return a file of the page; other names are not found."""
    known = {each.name: each for each in files(__package__).joinpath("page").iterdir()}
    if name not in known or os.path.splitext(name)[1] not in _TYPES:
        return None
    return known[name].read_bytes()


async def _body(request: Any, most: int, write: Callable[[bytes], Any] | None = None) -> bytes | None:
    """Return the body of a request, or pass it to ``write``; None if it is too large."""
    size, parts = 0, []
    async for part in request.stream():
        size += len(part)
        if size > most:
            return None
        if write is None:
            parts.append(part)
        else:
            write(part)
    return b"".join(parts)


def _message(body: bytes) -> dict[str, Any] | None:
    try:
        message = json.loads(body)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None
