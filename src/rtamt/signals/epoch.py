"""Human-readable times since 1970: a date, and the seconds since the start of the trace."""

from __future__ import annotations

from rtamt.language.units.durations import decimal
from rtamt.lazy.modules import dt
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

#: Seconds since 1970 that a clock may show, of the years 2001 to 2099; nothing else is recorded for so long.
_FIRST, _LAST = 10**9, 4_102_444_800


def is_epoch(seconds: Fraction | float) -> bool:
    """Return whether a number of seconds is a time since 1970.

    >>> is_epoch(1_700_000_000.5), is_epoch(86_400)
    (True, False)
    """
    return _FIRST <= seconds < _LAST


def date_text(seconds: Fraction) -> str:
    """Return a time since 1970 as its date (UTC), with all its digits.

    >>> from fractions import Fraction
    >>> date_text(Fraction(1_700_000_000_100_000_001, 10**9))
    '2023-11-14 22:13:20.100000001'
    """
    whole = seconds // 1
    date = dt.datetime.fromtimestamp(int(whole), dt.timezone.utc).strftime("%Y-%m-%d %H:%M:%S")
    fraction = f"{decimal(seconds - whole)}" if seconds != whole else "0"
    return f"{date}{fraction[1:]}"


def moment_text(seconds: Fraction, start: Fraction) -> str:
    """Return a time since 1970 as its date and the seconds since the start of the trace.

    >>> from fractions import Fraction
    >>> moment_text(Fraction(1_700_000_002), Fraction(1_700_000_000))
    '2023-11-14 22:13:22 (+2 s)'
    """
    return f"{date_text(seconds)} (+{decimal(seconds - start)} s)"
