"""RTAMT's module path for STL in discrete time."""
