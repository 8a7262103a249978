"""Compile a formula to a program: instructions, delays, parameters, and bytes that run without Python.

=============  ==========================================================================
module         purpose
=============  ==========================================================================
lower          formulas to instructions
emission       the instructions so far: value numbering, lags, alignment of operands
order          the order in which the operands of operators are lowered, and recipes followed
time_lowering  what lowering decides by the time domain
places         the core formulas of instructions, for messages and programs that report sub-formulas
plan           formulas to one program (online) or a sequence of programs (offline)
stored         plans without formulas, which bytes can carry
slices         parts of a program: the instructions that some of its outputs need
shared         programs and plans that are compiled once for all values of parameters
graph          the graph that gives verdicts and bounds before the horizon, and its nodes
time_graph     what that graph decides by the time domain
early          formulas to that graph, and their values at the start of the trace
causation      the parts of formulas in that graph, of which causation is computed
hoist          constants out of windows and delays, which can then be shared
passes         the passes over a program, and how to leave them out
program        the program: instructions, serialisation, disassembly
metadata       names, period and labels stored with a program
=============  ==========================================================================
"""
