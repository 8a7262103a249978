"""The model description of an exported unit."""

from __future__ import annotations

import fmpy
import pytest

import rtamt
from rtamt import fmi
from rtamt.errors import UsageError
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


TYPED = """enum Mode { MANUAL, AUTO = 4 }  enum Far { NEAR, FAR = 3000000000 }  enum Late { LATE = 2 }
    input Mode mode  input bool armed  input Far far  input Late late  input float x
    parameter Mode start = AUTO  parameter bool strict = true
    always[0:1s](armed and mode == start and far == FAR and late == LATE and (strict -> x <= 3))"""


@BOTH
def test_booleans_and_enumerations_have_their_types(exported, version):
    described = fmpy.read_model_description(str(exported(TYPED, version, period="1s")))
    real, integer = ("Real", "Integer") if version == 2 else ("Float64", "Int32")
    found = {v.name: v for v in described.modelVariables}
    assert {name: found[name].type for name in ("mode", "armed", "far", "late", "x", "start", "strict")} == {
        "mode": "Enumeration",
        "armed": "Boolean",
        "far": real,  # a code is no integer of 32 bits
        "late": integer,  # no item is 0, with which inputs start
        "x": real,
        "start": "Enumeration",
        "strict": "Boolean",
    }
    assert [found[name].start for name in ("mode", "armed", "start", "strict")] == ["0", "false", "4", "true"]
    assert found["mode"].declaredType.name == "Mode"
    (mode,) = described.typeDefinitions
    assert [(item.name, int(item.value)) for item in mode.items] == [("MANUAL", 0), ("AUTO", 4)]


@pytest.mark.parametrize(
    ("name", "wrong"), [("a\x01b", r"'\x01'"), ("a\ufffe", r"'\ufffe'"), ("\x7fé", None)]
)
def test_names_that_xml_cannot_contain_are_rejected(tmp_path, name, wrong):
    spec, path = rtamt.parse(f'"{name}" > 1', period=1), tmp_path / "unit.fmu"
    if wrong is None:
        fmi.export(spec, path)
        assert fmpy.read_model_description(str(path)).modelVariables[0].name == name
        return
    with pytest.raises(UsageError) as refused:
        fmi.export(spec, path)
    assert str(refused.value) == (
        f"the input {name!a} contains {wrong}, which XML cannot represent: rename it in the specification"
    )
    assert not path.exists()
