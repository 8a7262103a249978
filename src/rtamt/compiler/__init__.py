"""Compile a formula to a program: instructions, delays, parameters, and bytes that run without Python.

=========  =====================================================================
module     purpose
=========  =====================================================================
lower      formula to instructions: value numbering, lags, alignment of operands
plan       formulas to one program (online) or a sequence of programs (offline)
shared     programs and plans that are compiled once for all values of parameters
early      formulas to the graph that gives verdicts and bounds before the horizon
causation  the parts of formulas in that graph, of which causation is computed
program    the program: instructions, serialisation, disassembly
metadata   names, period and labels stored with a program
=========  =====================================================================
"""
