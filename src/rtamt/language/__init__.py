"""Convert text to formulas and back; this package does not depend on signals.

``operators.py`` contains the operator table, which drives the lexer, the parser, the printer, the checks, the
compiler, the documentation and the test generators.

===============  =========================================================================================
module           purpose
===============  =========================================================================================
operators        the table: every operator of the language, once
records          the records ``Operator`` and ``Language`` (an immutable set of operators)
rows             shorthands for rows of the table
lazy_modules     modules of functions, imported when one of these is called
expansions       derived operators in terms of simpler ones
unwritten        operators that no text contains: truths of predicates, parts of expansions
formula          formulas: three immutable node types
contents         the operators, variables and constants of formulas
equal_nodes      which nodes were found equal
value_types      the types of variables that are no plain numbers: Booleans, enumerations
enumerations     ``enum Mode { MANUAL, AUTO = 4 }``
shares           the share of a window that an operator needs
document         the content of a specification file
quantifiers      ``group cars = "car_*"``, and the quantifiers over its members
words            the words and symbols by their roles, for highlighting and completion
tables           ``table name = {(x, y), ...}``, a function of one number
substitution     formulas with one part replaced
parameters       values of parameters, set without parsing again
distinct         distinct names for formats that have fewer characters
exact_number     numbers that bound intervals: doubles with the exact value that they were given as
undefined_value  the error for undefined values, shared by both back ends
definitions      define what each operator means: pure functions, and their interval extensions
parsing          convert text to formulas and documents: tokens, grammar, declarations, templates, imports
printing         convert formulas to text, RTAMT's canonical text and LaTeX
units            convert durations, and check physical units through formulas
===============  =========================================================================================
"""
