"""RTAMT's module path for interface-aware STL."""
