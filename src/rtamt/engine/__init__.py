"""Evaluate formulas on signals: offline on complete recordings, online sample by sample.

====================  ============================================================================
module                purpose
====================  ============================================================================
domains               the engine of each time domain: back ends and monitor
backend               the interface of a back end
offline               evaluate queries on a recording; cache compiled plans
evaluate              offline evaluation in discrete time
dense_evaluate        offline evaluation in dense time
bounded               offline bounds of recordings with missing or uncertain samples
online                watched formulas and copies, shared by the monitors
monitor               the discrete-time monitor
dense_monitor         the dense-time monitor
dense_groups          several requirements in dense time, each with the trace of its own variables
gate                  reject concurrent and reentrant use of a monitor
native                load the compiled core
python_backend        the reference implementation behind the interface of the core, discrete time
dense_python_backend  the same in dense time
early_python_backend  the definition of bounds behind the interface of the core's EarlyMonitor
user_operators        call custom operators from the core
_core                 the compiled core (``core/``); the stub describes its interface
====================  ============================================================================
"""
