"""RTAMT's module path for STL."""
