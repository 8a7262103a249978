"""RTAMT's module path for the discrete-time classes of interface-aware STL."""

from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOfflineSpecification as IAStlInputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOnlineSpecification as IAStlInputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDiscreteTimeOfflineSpecification as IAStlInputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDiscreteTimeOnlineSpecification as IAStlInputVacuityDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOfflineSpecification as IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOnlineSpecification as IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOfflineSpecification as IAStlOutputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOnlineSpecification as IAStlOutputVacuityDiscreteTimeOnlineSpecification,
)
