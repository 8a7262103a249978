"""Tests of ``rtamt.play``."""
