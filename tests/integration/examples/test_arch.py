"""The benchmarks: the plants have the known figures, and falsification finds what is known to be there."""

import doctest

import pytest

from rtamt.search import PiecewiseConstant, falsify


@pytest.mark.parametrize("name", ["arch/cars", "arch/transmission", "elevator/elevator"])
def test_the_examples_in_docstrings(example, name):
    tested = doctest.testmod(example(*name.split("/")))
    assert tested.failed == 0
    assert tested.attempted > 0


@pytest.fixture
def cars(example):
    return example("arch", "cars")


@pytest.fixture
def transmission(example):
    return example("arch", "transmission")


def held(*values):
    return PiecewiseConstant(len(values), 0, 1000).signal(
        {str(k): float(value) for k, value in enumerate(values)}, 30.0
    )


def test_full_throttle_just_passes_the_limits_of_at1_and_at2(transmission):
    full = transmission.drive(held(100), held(0))
    assert 120 < max(full["speed"][:2001]) < 121
    assert 4750 < max(full["rpm"][:1001]) < 4800
    gears = full["gear"]
    assert [gear for k, gear in enumerate(gears) if k == 0 or gear != gears[k - 1]] == [1, 2, 3, 4]


def test_mined_parameters_are_those_of_the_report(example):
    mined = example("arch", "mine")
    with open(mined.__file__.replace("mine.py", "mining.md"), encoding="utf-8") as report:
        assert report.read() == mined.table()


def test_the_brake_slows_the_car_and_never_drives_it_backwards(transmission):
    rolling = transmission.drive(held(100, 0, 0), held(0, 0, 0))
    braked = transmission.drive(held(100, 0, 0), held(0, 325, 325))
    assert braked["speed"][1000] == rolling["speed"][1000] > 80
    assert braked["speed"][-1] < rolling["speed"][-1] - 10
    assert min(transmission.drive(held(0), held(325))["speed"]) == 0


def test_chasing_cars_keep_their_distance_where_the_first_one_drives_evenly(cars):
    places = cars.chase(held(0.2), held(1))
    distances = [
        [y - x for x, y in zip(places[first], places[second], strict=True)]
        for first, second in zip(cars.CARS[:-1], cars.CARS[1:], strict=True)
    ]
    assert min(map(min, distances)) > 4
    assert max(map(max, distances)) < 25


def test_a_change_of_mode_is_found_within_the_step(cars):
    follower = cars.Follower(place=10.2, speed=20.0, mode=cars.CHASING)
    follower.move(0.0, 0.0)  # reaches a distance of 10 after 10 ms of 25, then goes back
    assert follower.mode == cars.KEEPING
    assert follower.place == pytest.approx(10 + 20.01 * 0.015, abs=1e-3)


@pytest.mark.parametrize("name", ["AT2", "AT51", "AT53", "CC3", "CC5"])
def test_falsified_within_a_short_budget(example, name):
    benchmark = next(b for b in example("arch", "benchmarks").BENCHMARKS if b.name == name)
    found = falsify(benchmark.problem(), budget=80, seed=1)
    assert found.falsified
    assert not benchmark.problem().run(found.best.point).satisfied


def test_the_table_is_printed_with_the_published_formulas(example, capsys):
    run = example("arch", "run")
    run.main(["AT53", "--seeds", "2", "--optimizers", "random", "--budget", "50", "--workers", "1"])
    printed = capsys.readouterr().out
    assert "| formula | random | reported elsewhere |\n|---|---|---|\n| AT53 | 2/2, " in printed
    assert "published: `G[0,30] ((not g3 and F[0.001,0.1] g3)" in printed
    assert "monitored: `always[0:30]((not(abs(gear - 3) <= 0.5)" in printed
