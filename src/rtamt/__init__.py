"""Monitor Signal Temporal Logic: compute the robustness of requirements on recorded or live signals."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.discrete.monitor import Monitor
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
from rtamt.results import Result, first_violation
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import Discrete
from rtamt.signals.outcomes import Interval, Verdict, VerdictRun
from rtamt.signals.signal import Signal
from rtamt.specification import Specification
from rtamt.texts import load, parse, robustness

if TYPE_CHECKING:
    from rtamt.batch import evaluate_all, evaluate_batch
    from rtamt.readers.read import read, scan
    from rtamt.rtamt_api import (
        IAStlInputRobustnessDenseTimeOfflineSpecification,
        IAStlInputRobustnessDenseTimeOnlineSpecification,
        IAStlInputRobustnessDiscreteTimeOfflineSpecification,
        IAStlInputRobustnessDiscreteTimeOnlineSpecification,
        IAStlInputVacuityDenseTimeOfflineSpecification,
        IAStlInputVacuityDenseTimeOnlineSpecification,
        IAStlInputVacuityDiscreteTimeOfflineSpecification,
        IAStlInputVacuityDiscreteTimeOnlineSpecification,
        IAStlOutputRobustnessDenseTimeOfflineSpecification,
        IAStlOutputRobustnessDenseTimeOnlineSpecification,
        IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
        IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
        IAStlOutputVacuityDenseTimeOfflineSpecification,
        IAStlOutputVacuityDenseTimeOnlineSpecification,
        IAStlOutputVacuityDiscreteTimeOfflineSpecification,
        IAStlOutputVacuityDiscreteTimeOnlineSpecification,
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
    from rtamt.signals.trace import Channel, Trace
    from rtamt.verdicts.streaming import StreamResult, check_stream

__version__ = "1.0.0.dev0"

__all__ = [
    "STL",
    "BoundError",
    "Channel",
    "Dense",
    "DenseMonitor",
    "Discrete",
    "EvaluationError",
    "IAStlInputRobustnessDenseTimeOfflineSpecification",
    "IAStlInputRobustnessDenseTimeOnlineSpecification",
    "IAStlInputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlInputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlInputVacuityDenseTimeOfflineSpecification",
    "IAStlInputVacuityDenseTimeOnlineSpecification",
    "IAStlInputVacuityDiscreteTimeOfflineSpecification",
    "IAStlInputVacuityDiscreteTimeOnlineSpecification",
    "IAStlOutputRobustnessDenseTimeOfflineSpecification",
    "IAStlOutputRobustnessDenseTimeOnlineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOfflineSpecification",
    "IAStlOutputRobustnessDiscreteTimeOnlineSpecification",
    "IAStlOutputVacuityDenseTimeOfflineSpecification",
    "IAStlOutputVacuityDenseTimeOnlineSpecification",
    "IAStlOutputVacuityDiscreteTimeOfflineSpecification",
    "IAStlOutputVacuityDiscreteTimeOnlineSpecification",
    "Interval",
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
    "StreamResult",
    "TimeInterpretation",
    "Trace",
    "TraceError",
    "UsageError",
    "Verdict",
    "VerdictRun",
    "check_stream",
    "evaluate_all",
    "evaluate_batch",
    "first_violation",
    "load",
    "parse",
    "read",
    "robustness",
    "scan",
]

#: Names that are imported on first use, with their modules; all others are the paper's API.
_LATER = {
    "Channel": "rtamt.signals.trace",
    "StreamResult": "rtamt.verdicts.streaming",
    "Trace": "rtamt.signals.trace",
    "check_stream": "rtamt.verdicts.streaming",
    "evaluate_all": "rtamt.batch",
    "evaluate_batch": "rtamt.batch",
    "read": "rtamt.readers.read",
    "scan": "rtamt.readers.read",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'rtamt' has no attribute '{name}'")
    found = getattr(import_module(_LATER.get(name, "rtamt.rtamt_api")), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
