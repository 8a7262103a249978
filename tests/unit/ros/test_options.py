"""The arguments of the nodes: what holds where an argument, a parameter or nothing is given."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from rtamt.errors import UsageError
from rtamt.ros.options import options, parser

LISTING_8 = Path(__file__).parents[3] / "ros/rtamt4ros/specs/spec.stl"


def monitor(*arguments, **parameters):
    return options(parser("node").parse_args([str(a) for a in arguments]), parameters).monitor()


def test_unit_is_that_of_the_period_and_bounds_stay_seconds_as_in_the_papers_listing_5():
    watched = monitor(LISTING_8, "--period", "100", "--unit", "ms")
    assert watched.period == Fraction(1, 10)
    assert watched.groups[0].standings[0].horizon == 15


def test_an_argument_comes_before_a_parameter_and_that_before_the_default():
    assert monitor(spec=LISTING_8, time="dense").period is None
    assert monitor(spec=LISTING_8, period=0.5).period == Fraction(1, 2)
    assert monitor("--period", "5s", spec=LISTING_8, period=0.5).period == 5
    assert monitor(LISTING_8, "--time", "dense", "--stale", "0").time == "dense"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "no specification was given: name a file, or set the parameter spec"),
        (
            [LISTING_8],
            "discrete time samples the topics once a period: give it, such as --period 100ms (the parameter period), "
            "or use --time dense, which reads every message at its own time",
        ),
        (
            [LISTING_8, "--time", "dense", "--period", "1"],
            "dense time has no sampling period: leave out --period, or --time dense",
        ),
        (["--pace", "3"], "unrecognized arguments: --pace; see 'node --help'"),
        (
            [LISTING_8, "--time", "dens"],
            "unknown time domain 'dens'; did you mean 'dense'? (time domains: dense, discrete)",
        ),
    ],
)
def test_a_wrong_argument_is_a_sentence(arguments, sentence):
    with pytest.raises(UsageError) as caught:
        monitor(*arguments)
    assert str(caught.value) == sentence


def test_parameters_of_the_specification_are_set(tmp_path):
    spec = tmp_path / "spec.stl"
    text = LISTING_8.read_text().replace("@", "parameter float limit = 3\n@", 1)
    spec.write_text(text.replace("req.value>=3", "req.value>=limit"))
    for arguments, given in (([], {"set": "limit=4"}), (["--set", "limit=4"], {})):
        (output,) = monitor(spec, "--period", "1", *arguments, **given).binding.outputs
        assert "req.value >= 4" in str(output.specification)
    with pytest.raises(UsageError, match="there is no parameter 'limt'"):
        monitor(spec, "--period", "1", "--set", "limt=4")


def test_a_node_samples_as_the_specification_says_and_an_argument_replaces_it(tmp_path):
    spec = tmp_path / "spec.stl"
    spec.write_text(LISTING_8.read_text().replace("input", "sample 200ms hold for 1s skip nan\ninput", 1))
    watched = monitor(spec)
    assert (watched.period, watched._stale, watched.notices()) == (Fraction(1, 5), 10**9, [])
    assert watched._skip_nan
    assert not monitor(LISTING_8, "--period", 1)._skip_nan
    watched = monitor(spec, "--period", "100ms", "--stale", "3s")
    assert (watched.period, watched._stale) == (Fraction(1, 10), 3 * 10**9)
    assert [notice.message for notice in watched.notices()] == [
        "the period 100ms replaces that of 'sample 200ms hold for 1s skip nan' in the specification",
        "stale after 3s replaces the limit of 'sample 200ms hold for 1s skip nan' in the specification",
    ]
    assert monitor(spec, "--time", "dense").period is None
