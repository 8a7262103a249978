"""Convert text to formulas and back; this package does not depend on signals.

``operators.py`` contains the operator table, which drives the lexer, the parser, the printer, the checks, the
compiler, the documentation and the test generators.

=====================  =========================================================================
module                 purpose
=====================  =========================================================================
operators              the table: every operator of the language, once
records                the records ``Operator`` and ``Language`` (an immutable set of operators)
rows                   shorthands for rows of the table
expansions             derived operators in terms of simpler ones
unwritten              operators that no text contains: truths of predicates, parts of expansions
pointwise_definitions  the meaning of each operator of one instant: one pure function
functions              the meaning of sin, round, clip and the other mathematical functions
definitions            the discrete-time meaning of each temporal operator: one pure function
enclosures             interval extensions: operators of one instant on operands known up to bounds
function_enclosures    interval extensions of the mathematical functions
dense_definitions      the dense-time meaning of temporal operators, at one time
formula                formulas: three immutable node types
lexer                  text to tokens
parser                 tokens to a formula, and the grammar of formulas
grammar                rules shared by parser and printer: chaining, signs, nesting depth
intervals              bounds of temporal operators: units, exact values, errors
units                  durations with units
unit_library           physical units by pint
dimensions             the units of numbers, and whether they fit together
unit_rules             how the unit of a result follows from those of the operands
unit_check             dimensional analysis: declared units through the formulas of a text
names                  a position in a text, and what a name there stands for
value_types            the types of variables that are no plain numbers: Booleans, enumerations
type_rules             what Booleans and enumerations may stand in
typed_parser           members of enumerations and ``x in {...}`` in formulas
scope                  names in a formula: constants, named formulas, declared variables
template_order         templates that a text defines further down, and cycles among them
templates              ``def name(parameters) = formula``, and its uses
imports                files that others import: where they may be, and what is taken from them
sampling               the sampling rule: ``sample 100ms hold``
import_parser          ``import "file.stl"``, ``from module import Class``
declarations           what stands before the formulas of a file: declarations, annotations
enumerations           ``enum Mode { MANUAL, AUTO = 4 }``
shares                 the share of a window that an operator needs
specfile               specification files (``.stl``) to a document, and their grammar
document               the content of a specification file
groups                 ``group cars = "car_*"``, and the quantifiers over its members
tables                 ``table name = {(x, y), ...}``, a function of one number
parameters             values of parameters, set without parsing again
requirements           ``require ID "text" severity WORD: formula``
lint                   the table of warnings
diagnostics            syntax error messages
printer                formula to text and RTAMT's canonical text
latex                  formula to LaTeX
parentheses            operands that need parentheses in a text, names that need quotes
writing                the text of a formula from pieces, and its beginning where it is too long
undefined_value        the error for undefined values, shared by both back ends
=====================  =========================================================================
"""
