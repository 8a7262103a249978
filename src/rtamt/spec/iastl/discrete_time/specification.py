"""RTAMT's module path for the discrete-time classes of interface-aware STL."""

from rtamt.rtamt_api.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOfflineSpecification as IAStlInputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOnlineSpecification as IAStlInputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlInputVacuityDiscreteTimeOfflineSpecification as IAStlInputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlInputVacuityDiscreteTimeOnlineSpecification as IAStlInputVacuityDiscreteTimeOnlineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOfflineSpecification as IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOnlineSpecification as IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOfflineSpecification as IAStlOutputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.rtamt_api.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOnlineSpecification as IAStlOutputVacuityDiscreteTimeOnlineSpecification,
)
