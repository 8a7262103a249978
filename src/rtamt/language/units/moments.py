"""Times in messages: seconds, or dates as the caller gave them."""

from __future__ import annotations

from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any


def time_text(seconds: float, *, dated: bool = False) -> str:
    """Return a time for a message: seconds, or where the caller gives dates, the date to the microsecond.

    ``dated``: whether ``seconds`` stands for a date, as seconds since 1970.

    >>> time_text(0.5), time_text(1_700_000_000.1, dated=True)
    ('0.5 s', '2023-11-14T22:13:20.1')
    """
    if not dated:
        return f"{seconds:.15g} s"  # all significant digits of a double
    return show_date(np.datetime64(round(seconds * 1e6), "us"))


def show_date(date: Any) -> str:
    """Return a ``datetime64`` as text, without zeros at the end of a fraction.

    >>> show_date(np.datetime64("2024-03-01T12:00:00.500000000"))
    '2024-03-01T12:00:00.5'
    """
    text = str(date)
    return text.rstrip("0").rstrip(".") if "." in text else text
