"""Convert text to formulas and documents: tokens, grammar, declarations, templates, imports.

===============  ========================================================================
module           purpose
===============  ========================================================================
lexer            text to tokens
grammar          rules shared by parser and printer: chaining, signs, nesting depth
parser           tokens to a formula, and the grammar of formulas
lookahead        which words are operators, and which are names
typed_parser     members of enumerations and ``x in {...}`` in formulas
intervals        bounds of temporal operators: units, exact values, errors
names            a position in a text, and the meaning of a name there
scope            names in a formula: constants, named formulas, declared variables
diagnostics      syntax error messages
templates        ``def name(parameters) = formula``, and its uses
statements       which statement begins at the current token
template_names   what names mean in the formula of a template
template_order   templates that a text defines further down, and cycles among them
imports          files that others import: where they may be, and what is taken from them
import_parser    ``import "file.stl"``, ``from module import Class``
declarations     the head of a file: declarations, annotations
groups           the groups of signals in a file, and the fields of their members
specfile         specification files (``.stl``) to a document, and their grammar
requirements     ``require ID "text" severity WORD: formula``
recovery         all errors of a text, not only the first one
sampling_clause  the sampling rule: ``sample 100ms hold``
type_rules       the operators that accept Booleans and enumerations
===============  ========================================================================
"""
