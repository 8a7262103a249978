"""RTAMT's module path for the discrete-time classes."""

from rtamt.rtamt_api import (
    Language,
    Semantics,
    StlDiscreteTimeOfflineSpecification,
    StlDiscreteTimeOnlineSpecification,
    StlDiscreteTimeOnlineSpecificationCpp,
    STLDiscreteTimeSpecification,
    StlDiscreteTimeSpecification,
    StlDiscreteTimeSpecificationCpp,
)

__all__ = [
    "Language",
    "STLDiscreteTimeSpecification",
    "Semantics",
    "StlDiscreteTimeOfflineSpecification",
    "StlDiscreteTimeOnlineSpecification",
    "StlDiscreteTimeOnlineSpecificationCpp",
    "StlDiscreteTimeSpecification",
    "StlDiscreteTimeSpecificationCpp",
]
