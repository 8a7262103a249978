"""Provide RTAMT's module paths of its syntax trees.

Formulas are defined in ``language/formula.py``, their syntax in ``language/operators.py`` and ``language/parsing``.
"""

from rtamt.compat.paths import provide
from rtamt.compat.trees import LtlAst, StlAst

provide(
    __name__,
    {
        "ast.parser.stl.specification_parser": {"StlAst": StlAst},
        "ast.parser.ltl.specification_parser": {"LtlAst": LtlAst},
    },
)
