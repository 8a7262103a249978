"""Libraries that only some programs need: imported where they are used, missed in one sentence."""

from __future__ import annotations

import importlib
from typing import Any

from rtamt.errors import UsageError


def library(module: str, what: str, extra: str) -> Any:
    """Import a library that an extra of ours installs; raise :class:`UsageError` where it is not there.

    ``what``: what needs it, the beginning of the sentence.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = (error.name or module).split(".")[0]
        raise UsageError(
            f"{what} needs the package '{package}', which is not installed: pip install 'rtamt[{extra}]'"
        ) from None
