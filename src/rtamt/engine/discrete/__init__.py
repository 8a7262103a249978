"""The engine of discrete time.

====================  ========================================================================
module                purpose
====================  ========================================================================
backends              the back ends: the compiled core and the definition
early                 what both back ends report before the horizon
evaluate              offline evaluation by the compiled core
monitor               the monitor
checked_samples       samples that the core does not take directly: conversions and errors
fleet                 many monitors of one formula: a record for each key in the compiled core
reorder_buffer        samples of many keys, put in the order of their times
recording             recordings that need no conversion, read by the core
quantifiers           the monitor of quantifiers over dynamic groups
member_executors      the executors of quantifiers, one for each member
time_axis             a recording in samples, as explanations evaluate it
python_backend        the definition behind the interface of the compiled monitor
early_python_backend  the definition of bounds behind the interface of the core's EarlyMonitor
====================  ========================================================================
"""

from rtamt.engine.discrete.backends import BACKENDS
from rtamt.engine.discrete.monitor import Monitor
from rtamt.engine.discrete.recording import read_discrete
from rtamt.engine.engine import Engine

ENGINE = Engine(BACKENDS, Monitor, read_discrete)
