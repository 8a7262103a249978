"""RTAMT's module path for the discrete-time classes."""

from rtamt.rtamt_api.discrete import (
    StlDiscreteTimeOfflineSpecification as StlDiscreteTimeOfflineSpecification,
)
from rtamt.rtamt_api.discrete_online import (
    StlDiscreteTimeOnlineSpecification as StlDiscreteTimeOnlineSpecification,
)
from rtamt.rtamt_api.discrete_online import (
    StlDiscreteTimeOnlineSpecificationCpp as StlDiscreteTimeOnlineSpecificationCpp,
)
from rtamt.rtamt_api.discrete_online import STLDiscreteTimeSpecification as STLDiscreteTimeSpecification
from rtamt.rtamt_api.discrete_online import StlDiscreteTimeSpecification as StlDiscreteTimeSpecification
from rtamt.rtamt_api.discrete_online import StlDiscreteTimeSpecificationCpp as StlDiscreteTimeSpecificationCpp
from rtamt.rtamt_api.options import Language as Language
from rtamt.rtamt_api.options import Semantics as Semantics
