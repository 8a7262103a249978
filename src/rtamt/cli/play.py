"""``rtamt play``: a local web page that evaluates a requirement while it is edited."""

from __future__ import annotations

import contextlib
import os
import secrets
import signal
import socket
import tempfile
from functools import partial
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import CommandError, add_time_option, find_pack, is_trace, read_text
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say
from rtamt.extras import library
from rtamt.readers.formats import format_of
from rtamt.signals.time_domains import time_domain
from rtamt.specification_loader import pack

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator

    from rtamt.play.server import Given
    from rtamt.play.worker_pool import WorkerPool

_DESCRIPTION = """\
Open a local web page: type a formula, draw signals or load a recording, and see robustness, verdict and explanation
at once. Scrub through time to see the state of an online monitor after each sample. The solver draws a trace that
satisfies or violates the requirement (pip install 'rtamt[analysis]'). Requires starlette and uvicorn:
pip install 'rtamt[play]'.

Ctrl-C stops the server.

Exit code: 0, or 2 if the page cannot be served."""

_EPILOG = """\
The server listens on this machine only, and answers only requests that bring the token of the printed address. The
page loads nothing from the network. A link that the page copies contains everything: the text, the signals and small
recordings; open it with 'rtamt play LINK'.

examples:
  rtamt play limits.stl
  rtamt play limits.stl drive.csv
  rtamt play limits.stl drive.mf4 --port 8080 --no-browser"""

_HOST = "127.0.0.1"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument(
        "spec",
        metavar="SPEC",
        nargs="?",
        help="a specification file (.stl), a pack, a formula in quotes, or a link that the page has copied",
    )
    parser.add_argument("trace", metavar="TRACE", nargs="?", help="a recording")
    add_time_option(parser)
    parser.add_argument(
        "--period",
        metavar="DURATION",
        default="",
        help="the sampling period, such as 100ms, unless SPEC declares one",
    )
    parser.add_argument("--port", metavar="PORT", type=int, default=0, help="the port (default: a free one)")
    parser.add_argument("--no-browser", action="store_true", help="only print the address")


def run(args: argparse.Namespace) -> int:
    """Serve the page until it is interrupted."""
    uvicorn = library("uvicorn", "rtamt play", "play")
    library("starlette", "rtamt play", "play")
    from rtamt.play.server import Place, application
    from rtamt.play.worker_pool import WorkerPool

    time_domain(args.time, args.period or None)  # raises the error of either
    if args.trace is None and is_trace(args.spec):
        args.spec, args.trace = None, args.spec
    given, folder, fragment = _page_state(args)
    with (
        _stopped_by_signals(),
        _socket(args.port) as listening,
        tempfile.TemporaryDirectory(prefix="rtamt-play-") as room,
    ):
        port = listening.getsockname()[1]
        empty, uploads = os.path.join(room, "empty"), os.path.join(room, "uploads")
        for each in (empty, uploads):
            os.mkdir(each)
        token = secrets.token_urlsafe(24)
        place = Place(
            token, (f"{_HOST}:{port}", f"localhost:{port}"), uploads, WorkerPool(empty, folder), given
        )
        if args.trace is not None:
            place.add(os.path.abspath(args.trace), os.path.basename(args.trace), ours=False)
        server = uvicorn.Server(
            uvicorn.Config(application(place), log_level="error", lifespan="off", server_header=False)
        )
        address = f"http://{_HOST}:{port}/{token}/{fragment}"
        _serve(server, place.workers, listening, partial(_announce, address, browser=not args.no_browser))
    return OK


def _announce(address: str, *, browser: bool) -> None:
    say(address, flush=True)
    if browser:
        import webbrowser

        webbrowser.open(address)


def _serve(server: Any, workers: WorkerPool, listening: socket.socket, announce: Callable[[], None]) -> None:
    """Serve until a signal arrives; then end the workers."""
    import asyncio

    loop = asyncio.new_event_loop()
    try:
        with contextlib.suppress(KeyboardInterrupt):  # how it is stopped
            announce()  # from here on, signals may arrive
            loop.run_until_complete(server.serve(sockets=[listening]))
        loop.run_until_complete(workers.close())
        loop.run_until_complete(loop.shutdown_asyncgens())
    finally:
        loop.close()


@contextlib.contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """End in order, so that no file is left behind, also when the process is terminated."""

    def stop(_number: int, _frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _socket(port: int) -> socket.socket:
    listening = socket.socket()
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((_HOST, port))
        listening.listen(128)  # before the address is printed
    except (OSError, OverflowError) as error:
        listening.close()
        reason = getattr(error, "strerror", None) or error
        raise CommandError(
            f"cannot listen on port {port}: {reason}; choose another one with --port"
        ) from None
    return listening


def _page_state(args: argparse.Namespace) -> tuple[Given, str | None, str]:
    """Return the initial state of the page, the folder of imported files, and the fragment of a link."""
    from rtamt.play.server import Given

    spec, text, name, folder, fragment = args.spec, "", "", None, ""
    if args.trace is not None and not os.path.exists(args.trace):
        raise CommandError(f"there is no recording '{args.trace}'")
    if args.trace is not None:
        format_of(args.trace)  # raises for an unknown extension
    if spec is not None and spec.startswith(("http://", "#")):
        fragment = f"#{spec.partition('#')[2]}"
        if fragment == "#":
            raise CommandError(f"the link '{spec}' contains nothing: it must have a part after '#'")
    elif spec is not None and os.path.isfile(spec):
        name, folder = os.path.basename(spec), os.path.dirname(os.path.abspath(spec))
        text = read_text(spec)
    elif spec is not None and spec.endswith(".stl"):
        raise CommandError(f"there is no file '{spec}'")
    elif spec is not None:
        packed = find_pack(spec)
        text, name = (spec, "") if packed is None else (pack(packed).text, packed)
    return Given(text, name, args.time, args.period, args.trace), folder, fragment
