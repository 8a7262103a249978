"""The engine of dense time.

==============  =====================================================================
module          purpose
==============  =====================================================================
backends        the back ends: the compiled core and the definition
evaluate        offline evaluation by the compiled core
monitor         the monitor
groups          several requirements, each with the trace of its own variables
python_backend  the definition behind the interface of the compiled monitor
==============  =====================================================================
"""
