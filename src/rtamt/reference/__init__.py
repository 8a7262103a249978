"""Evaluate formulas literally by their definition.

This package shares only the formula with the compiler and the engine, so that each verifies the other.

==================  ============================================================
module              purpose
==================  ============================================================
discrete            the definition in discrete time
dense               the definition in dense time
definition_adapter  run an operator that has only a definition inside the engine
==================  ============================================================
"""
