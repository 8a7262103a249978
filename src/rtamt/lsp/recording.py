"""Evaluation of a recording in another process, so that the server stays responsive."""

from __future__ import annotations

import asyncio
import json
import os
import sys
import tempfile
from typing import Any

#: The time limit of an evaluation in seconds.
SECONDS = 60.0


async def ask(request: dict[str, Any], seconds: float = SECONDS) -> dict[str, Any]:
    """Return the answer of :func:`rtamt.lsp.evaluation.answer`; an ``error`` where it takes too long."""
    # An empty folder is the current one there: no module of the edited project is imported by its name.
    with tempfile.TemporaryDirectory(prefix="rtamt-lsp-") as empty:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "rtamt.lsp.evaluation",
            cwd=empty,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        try:
            out, errors = await asyncio.wait_for(process.communicate(json.dumps(request).encode()), seconds)
        except asyncio.TimeoutError:
            return {"error": f"the recording takes longer than {seconds:g} s; rtamt check evaluates it"}
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode != 0:
            last = errors.decode(errors="replace").strip().splitlines()[-1:]
            return {"error": f"the recording cannot be evaluated: {''.join(last) or 'its process ended'}"}
        found: dict[str, Any] = json.loads(out)
        return found


def state_of(path: str) -> tuple[Any, ...]:
    """Return the version of a file, which changes when the file changes."""
    try:
        status = os.stat(path)
    except OSError:
        return (path,)
    return path, status.st_mtime_ns, status.st_size
