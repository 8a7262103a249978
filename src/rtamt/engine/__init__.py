"""Evaluate formulas on signals: offline on complete recordings, online sample by sample.

Other packages import the names below from here; the back ends (``backend``, ``early``) and the compiled core
(``native``), which need longer to load, from their modules. Only the code for one time domain imports the folder of
that domain.

==============  ==================================================================================
module          purpose
==============  ==================================================================================
engine          what an engine has: back ends, a monitor, a time axis; the engine of a time domain
discrete        the engine of discrete time
dense           the engine of dense time
backend         the interface of a back end, and what compiled back ends share
early           what monitors of early verdict modes ask of a back end, and what all back ends share for it
offline         evaluate queries on a recording; cache compiled plans
direct          the short way from data to robustness: one call
offline_bounds  offline bounds of recordings with missing or uncertain samples
time_axis       a recording divided into cells, as explanations evaluate it
slow_path       keep calls whose times are converted off the fast path
online          watched formulas and copies, shared by the monitors
fleet_keys      the keys of a fleet as the core reads them, and in errors
quantifiers     monitors of quantifiers over members that come and go, in both time domains
native          load the compiled core
cores           how many threads may evaluate one long trace
user_operators  call custom operators from the core
_core           the compiled core (``core/``); the stub describes its interface
==============  ==================================================================================
"""

from rtamt.engine.engine import BACKENDS, Engine, engine_of
from rtamt.engine.online import OnlineMonitor, Watched, grounded
from rtamt.engine.slow_path import SlowPath, inner_of
from rtamt.lazy import attributes
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.engine.offline import Evaluators, Query
    from rtamt.engine.time_axis import TimeAxis

__all__ = [
    "BACKENDS",
    "Engine",
    "Evaluators",
    "OnlineMonitor",
    "Query",
    "SlowPath",
    "TimeAxis",
    "Watched",
    "engine_of",
    "grounded",
    "inner_of",
]

#: Imported when they are first used: monitors do not need them.
_RECORDINGS = {
    "Evaluators": "rtamt.engine.offline",
    "Query": "rtamt.engine.offline",
    "TimeAxis": "rtamt.engine.time_axis",
}

__getattr__ = attributes(__name__, _RECORDINGS)
