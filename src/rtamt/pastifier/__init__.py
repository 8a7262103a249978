"""Provide RTAMT's module paths of pastification and horizons.

These are computed in ``rewrite/pastify.py`` and ``rewrite/horizon.py``.
"""

from rtamt.compat.paths import provide
from rtamt.compat.trees import LtlHorizon, LtlPastifier, StlHorizon, StlPastifier

provide(
    __name__,
    {
        "stl.pastifier": {"StlPastifier": StlPastifier},
        "stl.horizon": {"StlHorizon": StlHorizon},
        "ltl.pastifier": {"LtlPastifier": LtlPastifier},
        "ltl.horizon": {"LtlHorizon": LtlHorizon},
    },
)
