"""The module :mod:`datetime`, imported when it is first used: its import takes longer than that of five of our modules.

>>> from rtamt.lazy_datetime import dt
>>> dt.timedelta(minutes=1).total_seconds()
60.0
"""

from __future__ import annotations

from rtamt.lazy_typing import TYPE_CHECKING

if TYPE_CHECKING:
    import datetime as dt
else:
    from rtamt.lazy_numpy import Unloaded

    dt = Unloaded("datetime")

__all__ = ["dt"]
