"""Runtime monitors for Signal Temporal Logic: requirement and signal in, robustness out."""

from rtamt.engine.dense_monitor import DenseMonitor
from rtamt.engine.monitor import Monitor
from rtamt.engine.signals import Signal
from rtamt.engine.trace import Channel, Trace
from rtamt.errors import (
    BoundError,
    EvaluationError,
    NameInFormulaError,
    ParseError,
    RTAMTException,
    SpecificationError,
    StlError,
    STLParseException,
    TraceError,
    UsageError,
)
from rtamt.language.operators import STL
from rtamt.readers.reading import read
from rtamt.results import Result
from rtamt.rtamt_api import (
    Language,
    Semantics,
    STLCTSpecification,
    StlDenseTimeOfflineSpecification,
    StlDenseTimeOnlineSpecification,
    STLDenseTimeSpecification,
    StlDenseTimeSpecification,
    StlDiscreteTimeOfflineSpecification,
    StlDiscreteTimeOnlineSpecification,
    StlDiscreteTimeOnlineSpecificationCpp,
    STLDiscreteTimeSpecification,
    StlDiscreteTimeSpecification,
    StlDiscreteTimeSpecificationCpp,
    StlIOType,
    STLSpecification,
    TimeInterpretation,
)
from rtamt.specification import Specification, load, parse, robustness

__version__ = "1.0.0.dev0"

__all__ = [
    "STL",
    "BoundError",
    "Channel",
    "DenseMonitor",
    "EvaluationError",
    "Language",
    "Monitor",
    "NameInFormulaError",
    "ParseError",
    "RTAMTException",
    "Result",
    "STLCTSpecification",
    "STLDenseTimeSpecification",
    "STLDiscreteTimeSpecification",
    "STLParseException",
    "STLSpecification",
    "Semantics",
    "Signal",
    "Specification",
    "SpecificationError",
    "StlDenseTimeOfflineSpecification",
    "StlDenseTimeOnlineSpecification",
    "StlDenseTimeSpecification",
    "StlDiscreteTimeOfflineSpecification",
    "StlDiscreteTimeOnlineSpecification",
    "StlDiscreteTimeOnlineSpecificationCpp",
    "StlDiscreteTimeSpecification",
    "StlDiscreteTimeSpecificationCpp",
    "StlError",
    "StlIOType",
    "TimeInterpretation",
    "Trace",
    "TraceError",
    "UsageError",
    "load",
    "parse",
    "read",
    "robustness",
]
