"""What ``update`` is called with: one time, and each variable by its name; every kind of monitor reports the same."""

import numpy as np
import pytest

import rtamt

KINDS = [
    {"time": time, **verdict, **backend}
    for time in ("discrete", "dense")
    for verdict in ({}, {"verdict": "eager"}, {"verdict": "interval"}, {"verdict": "causation"})
    for backend in ({}, {"backend": "python"})
]


#: These read the samples in Python, too.
EXPLAINED = [{"time": time, "verdict": "eager", "explain": True} for time in ("discrete", "dense")]


def opened(kind, variable="x", formula="once[0:1]({} > 0)"):
    settings = dict(kind)
    spec = rtamt.parse(formula.format(variable), backend=settings.pop("backend", "cpp"))
    return spec.monitor(**settings)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
@pytest.mark.parametrize(
    ("args", "values", "count"),
    [((), {}, 0), ((0.0, {"x": 1.0}), {}, 2), ((0.0, [("x", 1.0)]), {}, 2), ((), {"x": 1.0}, 0)],
)
def test_a_wrong_number_of_times_is_no_type_error_of_a_private_function(kind, args, values, count):
    monitor = opened(kind)
    with pytest.raises(rtamt.UsageError) as caught:
        monitor.update(*args, **values)
    assert str(caught.value) == (
        "update() takes one time, and each variable by its name, such as update(0.5, x=1.0); "
        f"got {count} values without a name"
    )
    monitor.update(0.0, x=1.0)
    assert monitor.samples == 1


@pytest.mark.parametrize("kind", [*KINDS, *EXPLAINED], ids=lambda kind: "-".join(map(str, kind.values())))
@pytest.mark.parametrize("name", ["self", "time", "t", "given", "values", "key", "samples", "name"])
def test_a_variable_called_self_is_no_second_value_of_an_argument(kind, name):
    reports = []
    for variable in ("x", name):
        monitor = opened(kind, variable)
        taken = [monitor.update(place, **{variable: value}) for place, value in enumerate([2.0, 1, -1.0])]
        reports.append(repr(taken).replace(f"'{variable}'", "'x'"))
    assert reports[0] == reports[1]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
@pytest.mark.parametrize("name", ["self", "times", "keys"])
def test_fleets_take_a_variable_called_self(kind, name):
    settings = dict(kind)
    spec = rtamt.parse(
        f"once[0:1]({name} > 0)", backend=settings.pop("backend", "cpp"), time=settings.pop("time")
    )
    fleet = rtamt.Fleet(spec, 10, **settings)
    fleet.update_many(["a", "b"], [0, 0], {name: [1.0, 2.0]})
    fleet.update_many(["a", "b"], [1, 1], {name: [1, 2]})
    assert len(fleet) == 2


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    "values",
    [[7, 1], (7, 1), np.array([7, 1], object), np.ma.array([7, 1], mask=[0, 0]), np.array([7, 1], "f4")],
)
def test_a_variable_called_time_has_its_own_values_in_fleets(backend, values):
    fleet = rtamt.Fleet(rtamt.parse("time >= 3", backend=backend), 5)
    assert fleet.update_many([1, 1], [0, 1], {"time": values}).values.tolist() == [4, -2]
    with pytest.raises(rtamt.TraceError, match="'time' has 1 samples"):
        fleet.update_many([1, 1], [2, 3], {"time": np.array([7], object)})


@pytest.mark.parametrize("time", [{}, None, float("nan"), "soon"])
@pytest.mark.parametrize(
    "kind", [kind for kind in KINDS if kind["time"] == "dense"], ids=lambda k: "-".join(k.values())
)
def test_a_wrong_time_without_values_is_not_called_the_time_of_time(kind, time):
    with pytest.raises(rtamt.TraceError, match=r"^time is "):
        opened(kind).update(time)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
@pytest.mark.parametrize("number", [np.float16, np.float32])
def test_times_of_short_floats_cause_no_overflow_warning(kind, number):
    monitor = opened(kind)
    monitor.update(number(1), x=number(1))
    assert monitor.samples == 1
    for large in [np.float32(2e12), np.longdouble(2e12)]:
        with pytest.raises(rtamt.TraceError) as caught:
            opened(kind).update(large, x=1.0)
        assert "np." not in str(caught.value)
    timestamps = np.arange(3, dtype=number)
    assert (
        rtamt.parse("x >= 0", time=kind["time"]).evaluate({"time": timestamps, "x": timestamps}).robustness
        == 0
    )


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
@pytest.mark.parametrize("time", [1.7e18, 1.7e12, 10**18, np.int64(1_700_000_000_000)])
def test_early_monitors_took_nanoseconds_since_1970_for_seconds(kind, time):
    monitor = opened(kind)
    with pytest.raises(rtamt.TraceError, match=r"too large for seconds: if it counts .* since 1970"):
        monitor.update(time, x=1.0)
    monitor.update(1_700_000_000, x=1.0)
    assert monitor.samples == 1
