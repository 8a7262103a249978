"""RTAMT's module path for the discrete-time classes of interface-aware STL."""

from rtamt.rtamt_api import (
    IAStlInputRobustnessDiscreteTimeOfflineSpecification,
    IAStlInputRobustnessDiscreteTimeOnlineSpecification,
    IAStlInputVacuityDiscreteTimeOfflineSpecification,
    IAStlInputVacuityDiscreteTimeOnlineSpecification,
    IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
    IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
    IAStlOutputVacuityDiscreteTimeOfflineSpecification,
    IAStlOutputVacuityDiscreteTimeOnlineSpecification,
)

__all__ = [
    "IAStlInputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlInputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlInputVacuityDiscreteTimeOfflineSpecification",
    "IAStlInputVacuityDiscreteTimeOnlineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlOutputVacuityDiscreteTimeOfflineSpecification",
    "IAStlOutputVacuityDiscreteTimeOnlineSpecification",
]
