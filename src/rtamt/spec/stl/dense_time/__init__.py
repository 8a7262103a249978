"""RTAMT's module path for STL in dense time."""
