"""RTAMT's module path for the dense-time classes."""

from rtamt.rtamt_api import (
    Language,
    Semantics,
    STLCTSpecification,
    StlDenseTimeOfflineSpecification,
    StlDenseTimeOnlineSpecification,
    STLDenseTimeSpecification,
    StlDenseTimeSpecification,
)

__all__ = [
    "Language",
    "STLCTSpecification",
    "STLDenseTimeSpecification",
    "Semantics",
    "StlDenseTimeOfflineSpecification",
    "StlDenseTimeOnlineSpecification",
    "StlDenseTimeSpecification",
]
