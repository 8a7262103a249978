"""RTAMT's module path for its exception."""

from rtamt.errors import RTAMTException

__all__ = ["RTAMTException"]
