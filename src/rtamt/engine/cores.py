"""The number of threads that may evaluate one long trace.

``RTAMT_THREADS``, or else ``OMP_NUM_THREADS``, which pools such as joblib's and Dask's set in their workers. Otherwise
one for each core that this process may use; one in a worker of :mod:`multiprocessing`, whose siblings use the others.
"""

from __future__ import annotations

import os
import sys

#: More would wait for memory.
_MOST = 8


def threads() -> int:
    """Return the number of threads for a long trace."""
    for name in ("RTAMT_THREADS", "OMP_NUM_THREADS"):
        text = os.environ.get(name, "")
        if text.isascii() and text.isdigit():
            return min(max(int(text), 1), _MOST)
    multiprocessing = sys.modules.get("multiprocessing.process")
    if multiprocessing is not None and multiprocessing.parent_process() is not None:
        return 1
    if hasattr(os, "sched_getaffinity"):
        return min(len(os.sched_getaffinity(0)), _MOST)
    return min(os.cpu_count() or 1, _MOST)
