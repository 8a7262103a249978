"""Convert formulas to text, RTAMT's canonical text and LaTeX.

===========  =========================================================================
module       purpose
===========  =========================================================================
printer      formula to text and RTAMT's canonical text
latex        formula to LaTeX
english      formula to an English sentence
sentences    the sentences of a document: requirements, and what the names in them mean
parentheses  operands that need parentheses in a text, names that need quotes
writing      the text of a formula from pieces, and its beginning where it is too long
===========  =========================================================================
"""
