"""FRET: requirements in structured English (FRETish), read and written.

===========  ============================================================
module       purpose
===========  ============================================================
expressions  Boolean and numeric expressions, to trees
sentence     the fields of a sentence
lower        trees to formulas, with the types of variables
formalize    the formula of a sentence, from its fields
project      files of FRET to specifications
english      formulas to sentences: ``formalize`` and ``lower``, reversed
export       specifications to files of FRET
===========  ============================================================
"""
