"""Evaluate formulas on signals: offline on complete recordings, online sample by sample.

==============  ============================================================================
module          purpose
==============  ============================================================================
engine          what an engine has: back ends, a monitor, a time axis; the engine of a time domain
discrete        the engine of discrete time
dense           the engine of dense time
backend         the interface of a back end, and what compiled back ends share
offline         evaluate queries on a recording; cache compiled plans
offline_bounds  offline bounds of recordings with missing or uncertain samples
time_axis        a recording divided into cells, as explanations evaluate it
online          watched formulas and copies, shared by the monitors
quantifiers     monitors of quantifiers over members that come and go, in both time domains
usage_guard     reject concurrent and reentrant use of a monitor
native          load the compiled core
cores           how many threads may evaluate one long trace
user_operators  call custom operators from the core
_core           the compiled core (``core/``); the stub describes its interface
==============  ============================================================================
"""
