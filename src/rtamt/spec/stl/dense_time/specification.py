"""RTAMT's module path for the dense-time classes."""

from rtamt.rtamt_api import (
    STLCTSpecification,
    StlDenseTimeOfflineSpecification,
    StlDenseTimeOnlineSpecification,
    STLDenseTimeSpecification,
    StlDenseTimeSpecification,
)

__all__ = [
    "STLCTSpecification",
    "STLDenseTimeSpecification",
    "StlDenseTimeOfflineSpecification",
    "StlDenseTimeOnlineSpecification",
    "StlDenseTimeSpecification",
]
