"""Modules of this package that are imported when one of their functions is first called.

A monitor that the core computes calls no function of the operator table, a text without errors no diagnostics, and most
texts contain no table, enumeration, template or sampling rule.
"""

from __future__ import annotations

from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language import enumerations, expansions, shares, tables
    from rtamt.language.definitions import (
        dense,
        discrete,
        enclosures,
        function_enclosures,
        functions,
        pointwise,
    )
    from rtamt.language.parsing import diagnostics, ranges, sampling_clause, templates
    from rtamt.language.units import dimensions, rules
else:
    from rtamt.lazy.functions import Functions

    dense = Functions("rtamt.language.definitions.dense")
    diagnostics = Functions("rtamt.language.parsing.diagnostics")
    dimensions = Functions("rtamt.language.units.dimensions")
    discrete = Functions("rtamt.language.definitions.discrete")
    enclosures = Functions("rtamt.language.definitions.enclosures")
    enumerations = Functions("rtamt.language.enumerations")
    expansions = Functions("rtamt.language.expansions")
    function_enclosures = Functions("rtamt.language.definitions.function_enclosures")
    functions = Functions("rtamt.language.definitions.functions")
    pointwise = Functions("rtamt.language.definitions.pointwise")
    ranges = Functions("rtamt.language.parsing.ranges")
    rules = Functions("rtamt.language.units.rules")
    sampling_clause = Functions("rtamt.language.parsing.sampling_clause")
    shares = Functions("rtamt.language.shares")
    tables = Functions("rtamt.language.tables")
    templates = Functions("rtamt.language.parsing.templates")

__all__ = [
    "dense",
    "diagnostics",
    "dimensions",
    "discrete",
    "enclosures",
    "enumerations",
    "expansions",
    "function_enclosures",
    "functions",
    "pointwise",
    "ranges",
    "rules",
    "sampling_clause",
    "shares",
    "tables",
    "templates",
]
