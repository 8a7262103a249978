"""RTAMT's module path for the discrete-time classes."""

from rtamt.compat.discrete import (
    StlDiscreteTimeOfflineSpecification as StlDiscreteTimeOfflineSpecification,
)
from rtamt.compat.discrete_online import (
    StlDiscreteTimeOnlineSpecification as StlDiscreteTimeOnlineSpecification,
)
from rtamt.compat.discrete_online import (
    StlDiscreteTimeOnlineSpecificationCpp as StlDiscreteTimeOnlineSpecificationCpp,
)
from rtamt.compat.discrete_online import STLDiscreteTimeSpecification as STLDiscreteTimeSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeSpecification as StlDiscreteTimeSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeSpecificationCpp as StlDiscreteTimeSpecificationCpp
from rtamt.compat.options import Language as Language
from rtamt.compat.options import Semantics as Semantics
