"""Evaluate formulas literally by their definition.

This package shares only the formula with the compiler and the engine, so that each verifies the other.

==================  ============================================================
module              purpose
==================  ============================================================
discrete            the definition in discrete time
dense               the definition in dense time
discrete_bounds     bounds in discrete time, of traces that are known in part
dense_bounds        bounds in dense time
earliest            verdicts, each at the first sample that decides it
causation           by how much the newest sample alone violates or satisfies a formula
dense_causation     the same in dense time
cores               the core of a formula that is evaluated again with every sample
definition_adapter  run an operator that has only a definition inside the engine
==================  ============================================================
"""
