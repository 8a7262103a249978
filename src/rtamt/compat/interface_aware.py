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
    """Output robustness of finished traces in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputRobustnessDiscreteTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1], "req": [5.0, 4.0], "gnt": [1.5, 3.0]})
    [[0.0, -0.5], [1.0, 1.0]]
    """


class IAStlInputVacuityDiscreteTimeOfflineSpecification(InputVacuity, StlDiscreteTimeOfflineSpecification):
    """Input vacuity of finished traces in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputVacuityDiscreteTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1], "req": [1.0, 2.0], "gnt": [1.5, 3.0]})
    [[0.0, 2.0], [1.0, 1.0]]
    """


class IAStlInputRobustnessDiscreteTimeOfflineSpecification(
    InputRobustness, StlDiscreteTimeOfflineSpecification
):
    """Input robustness of finished traces in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputRobustnessDiscreteTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1], "req": [5.0, 4.0], "gnt": [1.5, 0.5]})
    [[0.0, -2.0], [1.0, -1.0]]
    """


class IAStlOutputVacuityDiscreteTimeOfflineSpecification(OutputVacuity, StlDiscreteTimeOfflineSpecification):
    """Output vacuity of finished traces in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputVacuityDiscreteTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1], "req": [5.0, 4.0], "gnt": [3.0, 4.5]})
    [[0.0, 1.0], [1.0, 2.5]]
    """


class IAStlOutputRobustnessDiscreteTimeOnlineSpecification(
    OutputRobustness, StlDiscreteTimeOnlineSpecification
):
    """Output robustness of a stream in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputRobustnessDiscreteTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(0, [("req", 5.0), ("gnt", 1.5)])
    -0.5
    >>> spec.update(1, [("req", 4.0), ("gnt", 3.0)])
    1.0
    """


class IAStlInputVacuityDiscreteTimeOnlineSpecification(InputVacuity, StlDiscreteTimeOnlineSpecification):
    """Input vacuity of a stream in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputVacuityDiscreteTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(0, [("req", 1.0), ("gnt", 1.5)])
    2.0
    >>> spec.update(1, [("req", 2.0), ("gnt", 3.0)])
    1.0
    """


class IAStlInputRobustnessDiscreteTimeOnlineSpecification(
    InputRobustness, StlDiscreteTimeOnlineSpecification
):
    """Input robustness of a stream in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputRobustnessDiscreteTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(0, [("req", 5.0), ("gnt", 1.5)])
    -2.0
    >>> spec.update(1, [("req", 4.0), ("gnt", 0.5)])
    -1.0
    """


class IAStlOutputVacuityDiscreteTimeOnlineSpecification(OutputVacuity, StlDiscreteTimeOnlineSpecification):
    """Output vacuity of a stream in discrete time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputVacuityDiscreteTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(0, [("req", 5.0), ("gnt", 3.0)])
    1.0
    >>> spec.update(1, [("req", 4.0), ("gnt", 4.5)])
    2.5
    """


class IAStlOutputRobustnessDenseTimeOfflineSpecification(OutputRobustness, StlDenseTimeOfflineSpecification):
    """Output robustness of finished signals in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputRobustnessDenseTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 1.5], [1, 3.0]]])
    [[0, -0.5], [1, 1.0]]
    """


class IAStlInputVacuityDenseTimeOfflineSpecification(InputVacuity, StlDenseTimeOfflineSpecification):
    """Input vacuity of finished signals in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputVacuityDenseTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate(["req", [[0, 1.0], [1, 2.0]]], ["gnt", [[0, 1.5], [1, 3.0]]])
    [[0, 2.0], [1, 1.0]]
    """


class IAStlInputRobustnessDenseTimeOfflineSpecification(InputRobustness, StlDenseTimeOfflineSpecification):
    """Input robustness of finished signals in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputRobustnessDenseTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 1.5], [1, 0.5]]])
    [[0, -2.0], [1, -1.0]]
    """


class IAStlOutputVacuityDenseTimeOfflineSpecification(OutputVacuity, StlDenseTimeOfflineSpecification):
    """Output vacuity of finished signals in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputVacuityDenseTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.evaluate(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 3.0], [1, 4.5]]])
    [[0, 1.0], [1, 2.5]]
    """


class IAStlOutputRobustnessDenseTimeOnlineSpecification(OutputRobustness, StlDenseTimeOnlineSpecification):
    """Output robustness of a stream in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputRobustnessDenseTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 1.5], [1, 3.0]]])
    [[0, -0.5], [1, 1.0]]
    """


class IAStlInputVacuityDenseTimeOnlineSpecification(InputVacuity, StlDenseTimeOnlineSpecification):
    """Input vacuity of a stream in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputVacuityDenseTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(["req", [[0, 1.0], [1, 2.0]]], ["gnt", [[0, 1.5], [1, 3.0]]])
    [[0, 2.0], [1, 1.0]]
    """


class IAStlInputRobustnessDenseTimeOnlineSpecification(InputRobustness, StlDenseTimeOnlineSpecification):
    """Input robustness of a stream in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlInputRobustnessDenseTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 1.5], [1, 0.5]]])
    [[0, -2.0], [1, -1.0]]
    """


class IAStlOutputVacuityDenseTimeOnlineSpecification(OutputVacuity, StlDenseTimeOnlineSpecification):
    """Output vacuity of a stream in dense time.

    >>> import rtamt
    >>> spec = rtamt.IAStlOutputVacuityDenseTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.declare_var("gnt", "float")
    >>> spec.set_var_io_type("req", "input")
    >>> spec.set_var_io_type("gnt", "output")
    >>> spec.spec = "(req >= 3) -> (gnt >= 2)"
    >>> spec.parse()
    >>> spec.update(["req", [[0, 5.0], [1, 4.0]]], ["gnt", [[0, 3.0], [1, 4.5]]])
    [[0, 1.0], [1, 2.5]]
    """
