"""The paper's API: programs written for RTAMT run unchanged, over the engine of this library.

Thin: the classes keep declarations, put the text together, and hand everything else to
:mod:`rtamt.language`, :mod:`rtamt.rewrite` and :mod:`rtamt.engine`.

==================  =====================================================================
module              what it holds
==================  =====================================================================
options             Semantics, Language, TimeInterpretation, StlIOType
declarations        what every class shares: names, types, topics, modules, the text
formulas            the formulas that were read: canonical text, values of sub-formulas
online              pastification, and where the result goes
discrete            discrete time: sampling period, the offline class
discrete_online     the online class, and the combined one
dense               dense time: the offline class, the online one, and the combined one
interface_aware     the classes for IA-STL: the same with another semantics
backends            the compiled core, or the definition where it is not built
associativity       the warning for chains that RTAMT read differently
failures            every error leaves as an RTAMTException
==================  =====================================================================
"""

from rtamt.rtamt_api.dense import (
    StlDenseTimeOfflineSpecification,
    StlDenseTimeOnlineSpecification,
    StlDenseTimeSpecification,
)
from rtamt.rtamt_api.discrete import StlDiscreteTimeOfflineSpecification
from rtamt.rtamt_api.discrete_online import (
    StlDiscreteTimeOnlineSpecification,
    StlDiscreteTimeOnlineSpecificationCpp,
    StlDiscreteTimeSpecification,
    StlDiscreteTimeSpecificationCpp,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlInputRobustnessDenseTimeOfflineSpecification,
    IAStlInputRobustnessDenseTimeOnlineSpecification,
    IAStlInputRobustnessDiscreteTimeOfflineSpecification,
    IAStlInputRobustnessDiscreteTimeOnlineSpecification,
    IAStlInputVacuityDenseTimeOfflineSpecification,
    IAStlInputVacuityDenseTimeOnlineSpecification,
    IAStlInputVacuityDiscreteTimeOfflineSpecification,
    IAStlInputVacuityDiscreteTimeOnlineSpecification,
    IAStlOutputRobustnessDenseTimeOfflineSpecification,
    IAStlOutputRobustnessDenseTimeOnlineSpecification,
    IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
    IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
    IAStlOutputVacuityDenseTimeOfflineSpecification,
    IAStlOutputVacuityDenseTimeOnlineSpecification,
    IAStlOutputVacuityDiscreteTimeOfflineSpecification,
    IAStlOutputVacuityDiscreteTimeOnlineSpecification,
)
from rtamt.rtamt_api.options import Language, Semantics, StlIOType, TimeInterpretation

#: Spellings of older programs and of the paper's ROS code.
STLSpecification = StlDiscreteTimeSpecification
STLDiscreteTimeSpecification = StlDiscreteTimeSpecification
STLCTSpecification = StlDenseTimeSpecification
STLDenseTimeSpecification = StlDenseTimeSpecification

__all__ = [
    "IAStlInputRobustnessDenseTimeOfflineSpecification",
    "IAStlInputRobustnessDenseTimeOnlineSpecification",
    "IAStlInputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlInputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlInputVacuityDenseTimeOfflineSpecification",
    "IAStlInputVacuityDenseTimeOnlineSpecification",
    "IAStlInputVacuityDiscreteTimeOfflineSpecification",
    "IAStlInputVacuityDiscreteTimeOnlineSpecification",
    "IAStlOutputRobustnessDenseTimeOfflineSpecification",
    "IAStlOutputRobustnessDenseTimeOnlineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlOutputVacuityDenseTimeOfflineSpecification",
    "IAStlOutputVacuityDenseTimeOnlineSpecification",
    "IAStlOutputVacuityDiscreteTimeOfflineSpecification",
    "IAStlOutputVacuityDiscreteTimeOnlineSpecification",
    "Language",
    "STLCTSpecification",
    "STLDenseTimeSpecification",
    "STLDiscreteTimeSpecification",
    "STLSpecification",
    "Semantics",
    "StlDenseTimeOfflineSpecification",
    "StlDenseTimeOnlineSpecification",
    "StlDenseTimeSpecification",
    "StlDiscreteTimeOfflineSpecification",
    "StlDiscreteTimeOnlineSpecification",
    "StlDiscreteTimeOnlineSpecificationCpp",
    "StlDiscreteTimeSpecification",
    "StlDiscreteTimeSpecificationCpp",
    "StlIOType",
    "TimeInterpretation",
]
