"""Traces per time domain: what the caller has, as float64 arrays, ticks and timestamps."""
