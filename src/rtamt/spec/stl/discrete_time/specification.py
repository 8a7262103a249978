"""RTAMT's module path for the discrete-time classes."""

from rtamt.rtamt_api import (
    StlDiscreteTimeOfflineSpecification,
    StlDiscreteTimeOnlineSpecification,
    StlDiscreteTimeOnlineSpecificationCpp,
    STLDiscreteTimeSpecification,
    StlDiscreteTimeSpecification,
    StlDiscreteTimeSpecificationCpp,
)

__all__ = [
    "STLDiscreteTimeSpecification",
    "StlDiscreteTimeOfflineSpecification",
    "StlDiscreteTimeOnlineSpecification",
    "StlDiscreteTimeOnlineSpecificationCpp",
    "StlDiscreteTimeSpecification",
    "StlDiscreteTimeSpecificationCpp",
]
