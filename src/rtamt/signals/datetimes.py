"""Dates and times of Python, numpy and pandas as nanoseconds, without a double in between."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np

from rtamt.language.units import UNITS

_EPOCH = datetime(1970, 1, 1)
_ZONED_EPOCH = _EPOCH.replace(tzinfo=timezone.utc)


def nanoseconds_of(time: Any) -> int | None:
    """Return a datetime or timedelta as nanoseconds, from 1970 if it is a date; None for what is none (NaT).

    A date without a time zone is taken as it stands, whatever the zone of this machine.

    >>> nanoseconds_of(datetime(1970, 1, 1, 0, 0, 1)), nanoseconds_of(np.timedelta64(5, "ms"))
    (1000000000, 5000000)
    """
    exact = getattr(time, "to_numpy", None)  # pandas counts in nanoseconds, datetime in microseconds
    if exact is not None:
        time = exact()
    if isinstance(time, np.datetime64 | np.timedelta64):
        if np.isnat(time):
            return None
        unit, _ = np.datetime_data(time.dtype)
        size = "ns" if unit in ("ns", "ps", "fs", "as") else "us" if unit in ("us", "ms") else "s"
        code = time.dtype.kind
        return int(time.astype(f"{code}8[{size}]").astype(np.int64)) * int(UNITS[size] / UNITS["ns"])
    since: timedelta = time
    if isinstance(time, datetime):
        since = time - (_EPOCH if time.tzinfo is None else _ZONED_EPOCH)
    return (since // timedelta(microseconds=1)) * 1000
