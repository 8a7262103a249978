"""Provide RTAMT's module paths for programs that import its classes from there."""
