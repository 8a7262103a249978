"""The generators of :mod:`rtamt.testing`, which users have too."""

from rtamt.testing.strategies import chunkings, dense_chunkings, dense_traces, formulas, traces

__all__ = ["chunkings", "dense_chunkings", "dense_traces", "formulas", "traces"]
