"""The model description of an exported unit."""

from __future__ import annotations

import fmpy

from tests.unit.fmi import BOTH


@BOTH
def test_names_are_those_of_the_requirement(exported, version):
    path = exported('req.value >= 1 and "a b" >= 0', version)
    description = fmpy.read_model_description(str(path))
    assert [v.name for v in description.modelVariables if v.causality == "input"] == ["req.value", "a b"]
    assert description.variableNamingConvention == "flat"
    plain = fmpy.read_model_description(str(exported("req.value >= 1", version)))
    assert plain.variableNamingConvention == "structured"


@BOTH
def test_declared_units_are_in_the_model_description(exported, version):
    text = """input float v [m/s]  float "q[2]" [rad]  float free  parameter float limit = 3 [m/s]
    always[0:1s](v >= limit and "q[2]" <= free)"""
    described = fmpy.read_model_description(str(exported(text, version, period="1s")))
    units = {variable.name: variable.unit for variable in described.modelVariables if variable.unit}
    assert units == {"v": "m/s", "q[2]": "rad", "limit": "m/s", "known_since": "s"}
    assert [unit.name for unit in described.unitDefinitions] == ["m/s", "rad", "s"]
    (limit,) = [variable for variable in described.modelVariables if variable.name == "limit"]
    assert (limit.causality, limit.variability, float(limit.start)) == ("parameter", "fixed", 3.0)
