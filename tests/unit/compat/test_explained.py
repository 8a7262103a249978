"""``explain()`` of the paper's offline classes."""

import pytest

import rtamt


def parsed(kind, text="always(x >= 3)"):
    spec = kind()
    spec.declare_var("x", "float")
    spec.spec = text
    spec.parse()
    return spec


@pytest.mark.parametrize(
    "kind",
    [
        rtamt.StlDiscreteTimeOfflineSpecification,
        rtamt.StlDiscreteTimeSpecification,
        rtamt.StlDenseTimeOfflineSpecification,
        rtamt.StlDenseTimeSpecification,
    ],
)
def test_the_latest_evaluation_is_explained(kind):
    spec = parsed(kind)
    with pytest.raises(rtamt.RTAMTException) as caught:
        spec.explain()
    assert str(caught.value) == "RTAMT Exception: there is nothing to explain yet; call evaluate() first"
    dense = "Dense" in kind.__name__
    for values, robustness in ([5, 1, 4], -2), ([5, 4, 4], 1):
        data = (
            [["x", [[t, x] for t, x in enumerate(values)]]] if dense else [{"time": [0, 1, 2], "x": values}]
        )
        assert spec.evaluate(*data)[0][1] == robustness
        explanation = spec.explain()
        assert (explanation.robustness, explanation.satisfied) == (robustness, robustness > 0)
        assert explanation.critical.time == 1
        assert explanation.critical.value == robustness
    assert spec.explain(2).robustness == 1
    with pytest.raises(rtamt.RTAMTException):
        spec.explain(7)
    spec.parse()
    with pytest.raises(rtamt.RTAMTException):
        spec.explain()


def test_a_pastified_formula_is_explained_as_such():
    spec = parsed(rtamt.StlDiscreteTimeSpecification, "eventually[0:1](x >= 3)")
    spec.pastify()
    spec.evaluate({"time": [0, 1, 2], "x": [1, 5, 4]})
    assert spec.explain(2).formula == "once[0:1](x >= 3)"
    assert spec.explain(2).causes[-1] == "'x >= 3' holds at 1 s (2)"
