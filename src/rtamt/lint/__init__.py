"""Warnings about valid but probably unintended specifications: a table of rules, each with a code to silence it.

===========  ====================================================================
module       purpose
===========  ====================================================================
rules        the table of the rules, from which the pages of the manual are made
found        what rules read and find: ``Text``, ``Rule``, ``Found``, ``LintWarning``
text_rules   rules about operands, declarations, names, units and times
ranges       rules that follow declared ranges through formulas
comparisons  rules about comparisons of one number with several constants
structure    rules about repeated parts and suspicious nesting
edits        where operators are written, and how they are removed
comments     comments that silence findings
report       all findings of a text
fix          a text with its findings fixed
===========  ====================================================================
"""
