"""RTAMT's module path for the dense-time classes."""

from rtamt.rtamt_api.dense import STLCTSpecification as STLCTSpecification
from rtamt.rtamt_api.dense import StlDenseTimeOfflineSpecification as StlDenseTimeOfflineSpecification
from rtamt.rtamt_api.dense import StlDenseTimeOnlineSpecification as StlDenseTimeOnlineSpecification
from rtamt.rtamt_api.dense import STLDenseTimeSpecification as STLDenseTimeSpecification
from rtamt.rtamt_api.dense import StlDenseTimeSpecification as StlDenseTimeSpecification
from rtamt.rtamt_api.options import Language as Language
from rtamt.rtamt_api.options import Semantics as Semantics
