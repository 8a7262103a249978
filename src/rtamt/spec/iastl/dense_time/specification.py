"""RTAMT's module path for the dense-time classes of interface-aware STL."""

from rtamt.rtamt_api import (
    IAStlInputRobustnessDenseTimeOfflineSpecification,
    IAStlInputRobustnessDenseTimeOnlineSpecification,
    IAStlInputVacuityDenseTimeOfflineSpecification,
    IAStlInputVacuityDenseTimeOnlineSpecification,
    IAStlOutputRobustnessDenseTimeOfflineSpecification,
    IAStlOutputRobustnessDenseTimeOnlineSpecification,
    IAStlOutputVacuityDenseTimeOfflineSpecification,
    IAStlOutputVacuityDenseTimeOnlineSpecification,
)

__all__ = [
    "IAStlInputRobustnessDenseTimeOfflineSpecification",
    "IAStlInputRobustnessDenseTimeOnlineSpecification",
    "IAStlInputVacuityDenseTimeOfflineSpecification",
    "IAStlInputVacuityDenseTimeOnlineSpecification",
    "IAStlOutputRobustnessDenseTimeOfflineSpecification",
    "IAStlOutputRobustnessDenseTimeOnlineSpecification",
    "IAStlOutputVacuityDenseTimeOfflineSpecification",
    "IAStlOutputVacuityDenseTimeOnlineSpecification",
]
