"""Provide RTAMT's module path of its exception."""
