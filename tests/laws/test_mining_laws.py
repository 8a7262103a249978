"""Mining against brute force: directions, tight values and fronts of generated templates."""

import re

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError, UsageError
from rtamt.mining import directions, mine
from tests.support.strategies import formulas, traces

#: A number in the text of a formula: a constant or a bound.
_LITERAL = re.compile(r"(?<![\w.%])\d+(?:\.\d+)?(?![\w.%])")
VALUES = (0.0, 1.0, 2.0, 3.0, 4.0)
RANGE = (0.0, 4.0)


#: Templates of two parameters with known directions, over x and y.
TWO = (
    "always(x <= {0}) and eventually(y >= {1})",
    "always(x > {0} -> eventually[0:{1}](y >= 1))",
    "eventually[0:{1}](always(x >= {0}))",
    "always[{0}:4](x - y <= {1})",
    "not (x >= {0} until[0:{1}] y >= 2)",
    "always(once[0:{0}](x >= 2) or y <= {1})",
    "historically(x <= 1) since[0:{1}] y < {0}",
    "always(maximum[0:{0}](x) <= {1})",
    "always(2 * x <= 3 * {0} + 1 or -y > {1} / 4)",
    "x < {0} or always(y <= {1} + min({1}, x))",
)
RECORDINGS = st.dictionaries(
    st.sampled_from("ab"),
    st.integers(1, 6).flatmap(
        lambda n: st.fixed_dictionaries(
            {name: st.lists(st.integers(-1, 5), min_size=n, max_size=n) for name in "xy"}
        )
    ),
    min_size=1,
)


@st.composite
def templates(draw):
    """Return a specification in whose text one number became the parameter p."""
    text = str(draw(formulas(max_depth=3, unbounded_future=True, infinite=False)))
    places = list(_LITERAL.finditer(text))
    assume(places)
    place = draw(st.sampled_from(places))
    text = f"{text[: place.start()]}p{text[place.end() :]}"
    try:
        spec = rtamt.parse(f"parameter float p = {place[0]}\n({text})", period=1)
        directed = directions(spec, {"p": RANGE})
    except StlError:  # no place for a parameter
        assume(False)
    assume(directed.get("p", "unknown") != "unknown")
    return spec, directed["p"]


def two(text, one=None):
    """Return a template of two parameters, or of the second alone, with the first one as a number."""
    if one is not None:
        return rtamt.parse(f"parameter float q = 2  {text.format(one, 'q')}", period=1)
    return rtamt.parse(f"parameter float p = 2  parameter float q = 2  {text.format('p', 'q')}", period=1)


def satisfied(spec, values, recordings):
    """Return whether recordings satisfy a template; None where it has no value."""
    try:
        changed = spec.with_parameters(**values)
        return all(changed.evaluate(data).satisfied for data in recordings.values())
    except StlError:
        return None


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(templates(), st.lists(traces(), min_size=2, max_size=2))
def test_a_known_direction_is_that_of_every_recording(template, drawn):
    spec, direction = template
    recordings = {str(k): {n: list(v) for n, v in trace.items()} for k, trace in enumerate(drawn)}
    verdicts = [satisfied(spec, {"p": value}, recordings) for value in VALUES]
    known = [verdict for verdict in verdicts if verdict is not None]
    assert known == sorted(known, reverse=direction == "smaller"), (spec, direction)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(TWO), st.integers(0, 4), RECORDINGS)
def test_one_value_is_the_hardest_that_holds(text, first, recordings):
    spec = two(text, first)
    direction = directions(spec)["q"]
    holding = [value for value in VALUES if satisfied(spec, {"q": value}, recordings)]
    if not holding:
        with pytest.raises(
            UsageError, match="no values in their ranges satisfy the specification on all recordings"
        ):
            mine(spec, recordings, ranges={"q": RANGE}, resolutions={"q": 1})
        return
    (point,) = mine(spec, recordings, ranges={"q": RANGE}, resolutions={"q": 1}).points
    assert point.values == {"q": min(holding) if direction == "larger" else max(holding)}
    assert bool(point.harder) == (len(holding) < len(VALUES))
    for value, name in zip(point.harder.values(), point.violated_by.values(), strict=True):
        assert abs(value - point.values["q"]) == 1
        assert satisfied(spec, {"q": value}, {name: recordings[name]}) is False


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(TWO), RECORDINGS)
def test_the_front_is_that_of_every_pair(text, recordings):
    spec = two(text)
    signs = [{"larger": 1, "smaller": -1}[direction] for direction in directions(spec).values()]
    holding = [(x, y) for x in VALUES for y in VALUES if satisfied(spec, {"p": x, "q": y}, recordings)]
    assume(holding)

    def harder(one, other):
        return one != other and all(s * a <= s * b for s, a, b in zip(signs, one, other, strict=True))

    expected = {pair for pair in holding if not any(harder(other, pair) for other in holding)}
    found = mine(spec, recordings, ranges=dict.fromkeys("pq", RANGE), resolutions=dict.fromkeys("pq", 1))
    assert {(point.values["p"], point.values["q"]) for point in found.points} == expected
    assert found.undecided == 0
    assert len(found.points) == len(expected)


def test_every_template_of_the_laws_has_known_directions():
    assert {direction for text in TWO for direction in directions(two(text)).values()} == {
        "larger",
        "smaller",
    }
