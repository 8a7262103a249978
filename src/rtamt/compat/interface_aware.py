"""The paper's classes for interface-aware STL: the STL classes with another default semantics.

Inputs are declared with ``set_var_io_type``, or with ``input`` and ``output`` in the
text; undeclared variables are outputs.
"""

from __future__ import annotations

from rtamt.compat.dense import StlDenseTimeOfflineSpecification, StlDenseTimeOnlineSpecification
from rtamt.compat.discrete import StlDiscreteTimeOfflineSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeOnlineSpecification
from rtamt.compat.formulas import Formulas
from rtamt.compat.options import Semantics


class OutputRobustness(Formulas):
    """Measures the change of outputs that would change the verdict, with fixed inputs."""

    _semantics = Semantics.OUTPUT_ROBUSTNESS


class InputVacuity(Formulas):
    """Measures the change of inputs that would change the verdict, for arbitrary outputs."""

    _semantics = Semantics.INPUT_VACUITY


class InputRobustness(Formulas):
    """Measures the change of inputs that would change the verdict, with fixed outputs."""

    _semantics = Semantics.INPUT_ROBUSTNESS


class OutputVacuity(Formulas):
    """Measures the change of outputs that would change the verdict, for arbitrary inputs."""

    _semantics = Semantics.OUTPUT_VACUITY


class IAStlOutputRobustnessDiscreteTimeOfflineSpecification(
    OutputRobustness, StlDiscreteTimeOfflineSpecification
):
    """Output robustness of finished traces in discrete time."""


class IAStlInputVacuityDiscreteTimeOfflineSpecification(InputVacuity, StlDiscreteTimeOfflineSpecification):
    """Input vacuity of finished traces in discrete time."""


class IAStlInputRobustnessDiscreteTimeOfflineSpecification(
    InputRobustness, StlDiscreteTimeOfflineSpecification
):
    """Input robustness of finished traces in discrete time."""


class IAStlOutputVacuityDiscreteTimeOfflineSpecification(OutputVacuity, StlDiscreteTimeOfflineSpecification):
    """Output vacuity of finished traces in discrete time."""


class IAStlOutputRobustnessDiscreteTimeOnlineSpecification(
    OutputRobustness, StlDiscreteTimeOnlineSpecification
):
    """Output robustness of a stream in discrete time."""


class IAStlInputVacuityDiscreteTimeOnlineSpecification(InputVacuity, StlDiscreteTimeOnlineSpecification):
    """Input vacuity of a stream in discrete time."""


class IAStlInputRobustnessDiscreteTimeOnlineSpecification(
    InputRobustness, StlDiscreteTimeOnlineSpecification
):
    """Input robustness of a stream in discrete time."""


class IAStlOutputVacuityDiscreteTimeOnlineSpecification(OutputVacuity, StlDiscreteTimeOnlineSpecification):
    """Output vacuity of a stream in discrete time."""


class IAStlOutputRobustnessDenseTimeOfflineSpecification(OutputRobustness, StlDenseTimeOfflineSpecification):
    """Output robustness of finished signals in dense time."""


class IAStlInputVacuityDenseTimeOfflineSpecification(InputVacuity, StlDenseTimeOfflineSpecification):
    """Input vacuity of finished signals in dense time."""


class IAStlInputRobustnessDenseTimeOfflineSpecification(InputRobustness, StlDenseTimeOfflineSpecification):
    """Input robustness of finished signals in dense time."""


class IAStlOutputVacuityDenseTimeOfflineSpecification(OutputVacuity, StlDenseTimeOfflineSpecification):
    """Output vacuity of finished signals in dense time."""


class IAStlOutputRobustnessDenseTimeOnlineSpecification(OutputRobustness, StlDenseTimeOnlineSpecification):
    """Output robustness of a stream in dense time."""


class IAStlInputVacuityDenseTimeOnlineSpecification(InputVacuity, StlDenseTimeOnlineSpecification):
    """Input vacuity of a stream in dense time."""


class IAStlInputRobustnessDenseTimeOnlineSpecification(InputRobustness, StlDenseTimeOnlineSpecification):
    """Input robustness of a stream in dense time."""


class IAStlOutputVacuityDenseTimeOnlineSpecification(OutputVacuity, StlDenseTimeOnlineSpecification):
    """Output vacuity of a stream in dense time."""
