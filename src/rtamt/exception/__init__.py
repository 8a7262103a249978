"""RTAMT's module path for its exception."""
