"""What documents know of their formulas, and share with those that are selected from them."""

import rtamt
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document

TEXT = "low = x <= 3; same = x <= 3; high = y >= low; always(high)"


def test_the_first_of_several_names_stands_for_a_formula():
    names = parse_document(TEXT).names_of
    assert names[parse_formula("x <= 3")] == "low"
    assert parse_formula("always(y >= (x <= 3))") not in names


def test_a_selected_requirement_shares_names_and_groups():
    document = parse_document("require a: x >= 3\nrequire b: x >= 4")
    selected = document.select("b")
    assert selected.names_of is document.names_of
    assert selected.quantified_groups is document.quantified_groups


def test_another_value_of_a_parameter_gives_other_formulas_names():
    spec = rtamt.parse("parameter float c = 3\nlow = x <= c\nhigh = y <= c\nalways(low) and high")
    other = spec.with_parameters(c=4)
    assert [*map(str, other.document.names_of)] == ["x <= 4", "y <= 4"]


def test_a_replaced_formula_has_the_groups_that_it_ranges_over():
    spec = rtamt.parse(
        'group cars = "car_*"; group vans = "van_*"; forall c in cars: c.x > 5; forall v in vans: v.y > 5'
    )
    assert [*spec.groups] == ["cars", "vans"]
    assert spec.groups["vans"][1] == ("y",)
    quantified = rtamt.parse('group vans = "van_*"; forall v in vans: v.z > 5')
    assert {name: fields for name, (_, fields) in spec.with_formula(quantified.formula).groups.items()} == {
        "cars": ("x",),
        "vans": ("y", "z"),
    }
