"""RTAMT's module path for the dense-time classes."""

from rtamt.compat.dense import STLCTSpecification as STLCTSpecification
from rtamt.compat.dense import StlDenseTimeOfflineSpecification as StlDenseTimeOfflineSpecification
from rtamt.compat.dense import StlDenseTimeOnlineSpecification as StlDenseTimeOnlineSpecification
from rtamt.compat.dense import STLDenseTimeSpecification as STLDenseTimeSpecification
from rtamt.compat.dense import StlDenseTimeSpecification as StlDenseTimeSpecification
from rtamt.compat.options import Language as Language
from rtamt.compat.options import Semantics as Semantics
