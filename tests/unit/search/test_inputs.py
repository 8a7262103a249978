import numpy as np
import pytest

from rtamt.errors import UsageError
from rtamt.search import PiecewiseConstant, PiecewiseLinear, Pulse, Range, Sine, Step


def test_a_range_goes_from_its_lower_to_its_upper_end():
    assert [Range(-1, 3).at(x) for x in (0.0, 0.5, 1.0)] == [-1, 1, 3]


def test_a_range_never_leaves_its_ends_by_rounding():
    part = Range(0.1, 0.3)
    assert part.at(1.0) <= 0.3


@pytest.mark.parametrize(
    ("ends", "sentence"),
    [
        ((3, 3), "the range from 3 to 3 holds nothing; give the lower end first"),
        ((0, float("inf")), "a range ends at inf; give a finite number"),
        (("0", 1), "a range ends at '0'; give a finite number"),
    ],
)
def test_a_range_that_is_none(ends, sentence):
    with pytest.raises(UsageError) as caught:
        Range(*ends)
    assert str(caught.value) == sentence


def test_piecewise_constant_holds_each_number_equally_long():
    given = PiecewiseConstant(3, low=0, high=10)
    assert list(given.parameters()) == ["0", "1", "2"]
    signal = given.signal({"0": 1.0, "1": 5.0, "2": 2.0}, duration=9)
    np.testing.assert_array_equal(signal(np.array([0, 2.9, 3, 6, 9, 20])), [1, 1, 5, 2, 2, 2])


def test_piecewise_linear_goes_straight_from_number_to_number():
    signal = PiecewiseLinear(3, low=0, high=10).signal({"0": 0.0, "1": 10.0, "2": 0.0}, duration=4)
    np.testing.assert_array_equal(signal([0, 1, 2, 3, 4, 9]), [0, 5, 10, 5, 0, 0])


def test_a_shape_has_its_ranges_as_parameters():
    given = Pulse(amplitude=Range(1, 2), frequency=0.5, delay=Range(0, 1))
    assert given.parameters() == {"amplitude": Range(1, 2), "delay": Range(0, 1)}
    signal = given.signal({"amplitude": 1.5, "delay": 1.0}, duration=10)
    np.testing.assert_array_equal(signal([0, 0.9, 1, 1.9, 2, 3]), [0, 0, 1.5, 1.5, 0, 1.5])


def test_step_and_sine():
    assert Step(time=2, before=1, after=3)(1.999) == 1
    assert Step(time=2, before=1, after=3)(2) == 3
    assert Sine(amplitude=3, frequency=1, phase=np.pi / 2, offset=1)(0) == 4


def test_a_signal_with_a_range_left_has_no_values():
    with pytest.raises(
        UsageError, match="'amplitude' of this Sine is a Range: a signal needs a number there"
    ):
        Sine(amplitude=Range(0, 1))(0.0)


def test_too_few_points():
    with pytest.raises(UsageError, match="a PiecewiseLinear has 1 points; it needs 2 or more"):
        PiecewiseLinear(1, low=0, high=1)


def test_a_shape_of_words():
    with pytest.raises(UsageError, match="'time' of Step is 'soon'; give a number or a Range"):
        Step(time="soon")
