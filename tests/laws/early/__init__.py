"""Laws of verdicts before the horizon, for every monitor that gives them; the definition is one of them.

==============  ==========================================================================
module          purpose
==============  ==========================================================================
cases           random formulas, traces, and what is known of the traces
monitors        the monitors that must obey the laws: add one there
laws            the laws of discrete time, each a function of a case and a monitor
dense_laws      those of dense time
dense_failures  those of operations without a value there
specifications  laws of whole specifications: requirements, semantics, forms of times, copies
engines         the two engines of bounds in discrete time
soak            ``python -m tests.laws.early.soak 1000000``: the laws on that many cases
==============  ==========================================================================
"""
