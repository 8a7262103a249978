"""RTAMT's module path for the dense-time classes of interface-aware STL."""

from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDenseTimeOfflineSpecification as IAStlInputRobustnessDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDenseTimeOnlineSpecification as IAStlInputRobustnessDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDenseTimeOfflineSpecification as IAStlInputVacuityDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDenseTimeOnlineSpecification as IAStlInputVacuityDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDenseTimeOfflineSpecification as IAStlOutputRobustnessDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDenseTimeOnlineSpecification as IAStlOutputRobustnessDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDenseTimeOfflineSpecification as IAStlOutputVacuityDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDenseTimeOnlineSpecification as IAStlOutputVacuityDenseTimeOnlineSpecification,
)
