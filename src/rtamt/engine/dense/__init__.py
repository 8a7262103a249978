"""The engine of dense time.

====================  =====================================================================
module                purpose
====================  =====================================================================
backends              the back ends: the compiled core and the definition
early                 what both back ends report before the horizon: requirements, each with its own trace
evaluate              offline evaluation by the compiled core
monitor               the monitor
quantifiers           the monitor of quantifiers over dynamic groups
member_executors      what executes quantifiers: one executor for each member
steps                 the samples of a stream, cut at the instants up to which all are known
groups                several requirements, each with the trace of its own variables
time_axis             a recording in ticks, as explanations evaluate it
python_backend        the definition behind the interface of the compiled monitor
early_python_backend  the definition of bounds behind the interface of monitors before the horizon
====================  =====================================================================
"""

from rtamt.engine.dense.backends import BACKENDS
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.engine import Engine

ENGINE = Engine(BACKENDS, DenseMonitor)
