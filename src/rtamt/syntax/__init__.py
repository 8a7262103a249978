"""Provide RTAMT's module paths of its syntax trees."""

from rtamt.rtamt_api.paths import provide
from rtamt.rtamt_api.trees import LtlAst, StlAst

provide(
    __name__,
    {
        "ast.parser.stl.specification_parser": {"StlAst": StlAst},
        "ast.parser.ltl.specification_parser": {"LtlAst": LtlAst},
    },
)
