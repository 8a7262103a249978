"""Evaluate formulas literally by their definition.

This package shares only the formula with the compiler and the engine, so that each verifies the other.

===================  =====================================================================================
module               purpose
===================  =====================================================================================
discrete_robustness  robustness in discrete time
dense_robustness     robustness in dense time
discrete_bounds      bounds in discrete time, of traces that are known in part
dense_bounds         bounds in dense time
eager_verdicts       verdicts, each at the first sample that decides it
discrete_causation   by how much the newest sample alone violates or satisfies a formula, in discrete time
dense_causation      the same in dense time
cores                the core of a formula that is evaluated again with every sample
definition_adapter   run an operator that has only a definition inside the engine
===================  =====================================================================================
"""
