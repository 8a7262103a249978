"""The list of public names: type checkers read it, and ``__init__.py`` imports each name on first use."""

from rtamt.assertions import assert_satisfied as assert_satisfied
from rtamt.batch import evaluate_all as evaluate_all
from rtamt.batch import evaluate_batch as evaluate_batch
from rtamt.batch_results import BatchResult as BatchResult
from rtamt.compat.dense import STLCTSpecification as STLCTSpecification
from rtamt.compat.dense import StlDenseTimeOfflineSpecification as StlDenseTimeOfflineSpecification
from rtamt.compat.dense import StlDenseTimeOnlineSpecification as StlDenseTimeOnlineSpecification
from rtamt.compat.dense import STLDenseTimeSpecification as STLDenseTimeSpecification
from rtamt.compat.dense import StlDenseTimeSpecification as StlDenseTimeSpecification
from rtamt.compat.discrete import (
    StlDiscreteTimeOfflineSpecification as StlDiscreteTimeOfflineSpecification,
)
from rtamt.compat.discrete_online import LTLDiscreteTimeSpecification as LTLDiscreteTimeSpecification
from rtamt.compat.discrete_online import LTLSpecification as LTLSpecification
from rtamt.compat.discrete_online import (
    StlDiscreteTimeOnlineSpecification as StlDiscreteTimeOnlineSpecification,
)
from rtamt.compat.discrete_online import (
    StlDiscreteTimeOnlineSpecificationCpp as StlDiscreteTimeOnlineSpecificationCpp,
)
from rtamt.compat.discrete_online import STLDiscreteTimeSpecification as STLDiscreteTimeSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeSpecification as StlDiscreteTimeSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeSpecificationCpp as StlDiscreteTimeSpecificationCpp
from rtamt.compat.discrete_online import STLSpecification as STLSpecification
from rtamt.compat.failures import LTLException as LTLException
from rtamt.compat.failures import LTLNotImplementedException as LTLNotImplementedException
from rtamt.compat.failures import LTLOfflineException as LTLOfflineException
from rtamt.compat.failures import LTLParseException as LTLParseException
from rtamt.compat.failures import LTLPastifyException as LTLPastifyException
from rtamt.compat.failures import LTLSpecificationException as LTLSpecificationException
from rtamt.compat.failures import STLException as STLException
from rtamt.compat.failures import STLNotImplementedException as STLNotImplementedException
from rtamt.compat.failures import STLOfflineException as STLOfflineException
from rtamt.compat.failures import STLSpecificationException as STLSpecificationException
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDenseTimeOfflineSpecification as IAStlInputRobustnessDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDenseTimeOnlineSpecification as IAStlInputRobustnessDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOfflineSpecification as IAStlInputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputRobustnessDiscreteTimeOnlineSpecification as IAStlInputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDenseTimeOfflineSpecification as IAStlInputVacuityDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDenseTimeOnlineSpecification as IAStlInputVacuityDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDiscreteTimeOfflineSpecification as IAStlInputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlInputVacuityDiscreteTimeOnlineSpecification as IAStlInputVacuityDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDenseTimeOfflineSpecification as IAStlOutputRobustnessDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDenseTimeOnlineSpecification as IAStlOutputRobustnessDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOfflineSpecification as IAStlOutputRobustnessDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputRobustnessDiscreteTimeOnlineSpecification as IAStlOutputRobustnessDiscreteTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDenseTimeOfflineSpecification as IAStlOutputVacuityDenseTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDenseTimeOnlineSpecification as IAStlOutputVacuityDenseTimeOnlineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOfflineSpecification as IAStlOutputVacuityDiscreteTimeOfflineSpecification,
)
from rtamt.compat.interface_aware import (
    IAStlOutputVacuityDiscreteTimeOnlineSpecification as IAStlOutputVacuityDiscreteTimeOnlineSpecification,
)
from rtamt.compat.options import Language as Language
from rtamt.compat.options import Semantics as Semantics
from rtamt.compat.options import StlIOType as StlIOType
from rtamt.compat.options import TimeInterpretation as TimeInterpretation
from rtamt.engine.dense.monitor import DenseMonitor as DenseMonitor
from rtamt.engine.discrete.monitor import Monitor as Monitor
from rtamt.errors import BoundError as BoundError
from rtamt.errors import EvaluationError as EvaluationError
from rtamt.errors import NameInFormulaError as NameInFormulaError
from rtamt.errors import ParseError as ParseError
from rtamt.errors import RTAMTException as RTAMTException
from rtamt.errors import SpecificationError as SpecificationError
from rtamt.errors import StlError as StlError
from rtamt.errors import STLParseException as STLParseException
from rtamt.errors import TraceError as TraceError
from rtamt.errors import UsageError as UsageError
from rtamt.errors import WaitedError as WaitedError
from rtamt.fleet.fleet import Fleet as Fleet
from rtamt.fleet.reports import FleetBounds as FleetBounds
from rtamt.fleet.reports import FleetCausation as FleetCausation
from rtamt.fleet.reports import FleetPoints as FleetPoints
from rtamt.fleet.reports import FleetVerdicts as FleetVerdicts
from rtamt.fleet.reports import SuiteUpdate as SuiteUpdate
from rtamt.fleet.suite import Suite as Suite
from rtamt.fleet.updates import FleetUpdate as FleetUpdate
from rtamt.fleet.verdict_table import VerdictTable as VerdictTable
from rtamt.language.operators import STL as STL
from rtamt.readers.read import read as read
from rtamt.readers.read import scan as scan
from rtamt.results import Result as Result
from rtamt.signals.dense import Dense as Dense
from rtamt.signals.discrete import Discrete as Discrete
from rtamt.signals.episodes import Episode as Episode
from rtamt.signals.outcomes import Causation as Causation
from rtamt.signals.outcomes import CausationRun as CausationRun
from rtamt.signals.outcomes import Cause as Cause
from rtamt.signals.outcomes import Interval as Interval
from rtamt.signals.outcomes import Verdict as Verdict
from rtamt.signals.outcomes import VerdictRun as VerdictRun
from rtamt.signals.signal import Signal as Signal
from rtamt.signals.trace import Channel as Channel
from rtamt.signals.trace import Trace as Trace
from rtamt.specification import Specification as Specification
from rtamt.specification_loader import load as load
from rtamt.specification_loader import pack as pack
from rtamt.specification_loader import parse as parse
from rtamt.specification_loader import robustness as robustness
from rtamt.verdicts.chunks import StreamResult as StreamResult
from rtamt.verdicts.early.prediction import calibrate as calibrate
from rtamt.verdicts.streaming import check_stream as check_stream
from rtamt.violations import first_violation as first_violation

__version__: str
__all__: list[str]
