"""One requirement over many recordings, and many over one: the results of evaluating each by itself."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.language.contents import variables
from tests.support import strategies

NAN = float("nan")


def same(results, expected):
    assert len(results) == len(expected)
    for got, want in zip(results, expected, strict=True):
        np.testing.assert_array_equal(got.signal.times, want.signal.times)
        np.testing.assert_array_equal(got.signal.values, want.signal.values)
        assert got.satisfied == want.satisfied
        assert got.specification is want.specification
        assert set(got.trace.columns) == set(want.trace.columns)


# ---- many recordings -----------------------------------------------------------------------------


@pytest.mark.parametrize("workers", [None, 1, 2, 7])
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_results_come_in_the_order_of_the_recordings(workers, backend, time):
    spec = rtamt.parse("always(x >= 3 -> eventually[0:2](x <= 1))", backend=backend, time=time)
    random = np.random.default_rng(3)
    traces = [{"time": np.arange(n), "x": random.normal(2, 2, n)} for n in random.integers(1, 40, 25)]
    same(rtamt.evaluate_batch(spec, traces, workers=workers), [spec.evaluate(trace) for trace in traces])


def test_long_recordings_in_threads_give_what_each_gives_alone():
    spec = rtamt.parse("historically[0:100](x >= -3) since[1:50] (y >= 0)")
    random = np.random.default_rng(4)
    traces = [{"x": random.normal(size=20_000), "y": random.normal(size=20_000)} for _ in range(6)]
    same(rtamt.evaluate_batch(spec, traces, workers=3), [spec.evaluate(trace) for trace in traces])


def test_how_recordings_are_read_is_passed_on():
    spec = rtamt.parse("always[0:1](x >= 3)", roles={"x": "input"})
    traces = [{"time": [0, 0.54, 1.0], "x": [4, 5, 6]}]
    (result,) = rtamt.evaluate_batch(
        spec, traces, period="500ms", tolerance=0.2, semantics="output_robustness"
    )
    assert result.signal.values.tolist() == [np.inf] * 3
    (result,) = rtamt.evaluate_batch(spec, traces, time="dense", resolution="10ms")
    assert result.robustness == 1


def test_an_iterator_is_read_as_threads_become_free():
    taken, limit = [], threading.Semaphore(3)

    def traces():
        for n in range(20):
            taken.append(n)
            assert limit.acquire(timeout=10)
            yield Watched({"x": [n]}, limit)

    class Watched(dict):
        """A recording that says when it was read."""

        def __init__(self, data, limit):
            super().__init__(data)
            self.limit = limit

        def __getitem__(self, name):
            self.limit.release()
            return super().__getitem__(name)

    results = rtamt.evaluate_batch(rtamt.parse("x >= 5"), traces(), workers=2)
    assert [result.robustness for result in results] == [n - 5 for n in range(20)]
    assert taken == list(range(20))


def test_no_recordings_give_no_results():
    assert rtamt.evaluate_batch(rtamt.parse("x >= 5"), []) == []


@pytest.mark.parametrize("workers", [1, 4])
def test_the_first_wrong_recording_is_named_by_its_number(workers):
    traces = [{"x": [1, 2]}] * 3 + [{"x": [1, NAN]}] + [{"y": [1]}] + [{"x": [2]}] * 50
    with pytest.raises(rtamt.TraceError) as caught:
        rtamt.evaluate_batch(rtamt.parse("x >= 5"), traces, workers=workers)
    assert str(caught.value) == (
        "trace 3: 'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    )
    assert (caught.value.variable, caught.value.index, caught.value.time) == ("x", 1, 1.0)


def test_a_value_that_does_not_exist_and_a_bound_that_does_not_fit_name_the_recording_too():
    spec = rtamt.parse("1 / x >= 0 * (1 / x)")
    with pytest.raises(rtamt.EvaluationError, match=r"^trace 1: '0 \* \(1 / x\)' has no value at sample 1"):
        rtamt.evaluate_batch(spec, [{"x": [1]}, {"x": [1, 0]}])
    spec = rtamt.parse("always[0:500ms](x >= 3)")
    with pytest.raises(rtamt.BoundError) as caught:
        rtamt.evaluate_batch(spec, [{"time": [0, 0.5], "x": [1, 2]}, {"time": [0, 1], "x": [1, 2]}])
    assert str(caught.value).startswith("trace 1: ")
    assert str(caught.value).endswith("always[0:500ms](x >= 3)\n          ^^^^^^^^^")
    assert caught.value.message.startswith("trace 1: ")


def test_what_the_iterator_of_recordings_raises_is_raised():
    def traces():
        yield {"x": [1]}
        raise OSError("disk gone")

    with pytest.raises(OSError, match=r"^disk gone$"):
        rtamt.evaluate_batch(rtamt.parse("x >= 5"), traces(), workers=2)


@pytest.mark.parametrize("workers", [0, -1, 1.5, "two"])
def test_a_number_of_threads_that_is_none(workers):
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.evaluate_batch(rtamt.parse("x >= 5"), [{"x": [1]}], workers=workers)
    assert str(caught.value) == f"workers is {workers!r}; give a number of threads, 1 or more"


def test_recordings_that_are_none():
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.evaluate_batch(rtamt.parse("x >= 5"), 3)
    assert str(caught.value) == "traces is 3; give a list of recordings"


# ---- many requirements ---------------------------------------------------------------------------


@settings(max_examples=60)
@given(st.data())
def test_law_all_in_one_program_give_what_each_gives_alone(data):
    formulas = data.draw(st.lists(strategies.formulas(), min_size=1, max_size=4))
    specs = [rtamt.parse(str(formula)) for formula in formulas]
    names = ("x", *(name for formula in formulas for name in variables(formula)))
    trace = data.draw(strategies.traces(tuple(dict.fromkeys(names))))
    trace["time"] = np.arange(len(trace["x"]), dtype=float)
    try:
        expected = [spec.evaluate({k: trace[k] for k in ("time", *spec.input_names)}) for spec in specs]
    except rtamt.EvaluationError:
        with pytest.raises(rtamt.EvaluationError):
            rtamt.evaluate_all([*specs, rtamt.parse("x >= 0")], trace)
        return
    same(rtamt.evaluate_all([*specs, rtamt.parse("x >= 0")], trace)[:-1], expected)


def test_requirements_that_read_the_recording_each_in_its_own_way():
    data = {"time": [0.0, 0.5, 1.0], "x": [1, 5, 2], "y": [3, 1, 4]}
    texts = ("always(x >= 3)", "eventually[0:1](y >= x)", "x + y >= 3 until x >= 4")
    for backend in ("cpp", "python"):
        specs = [
            rtamt.parse(text, backend=backend, semantics=semantics, **settings)
            for text in texts
            for settings in (
                {},
                {"period": "500ms"},
                {"time": "dense"},
                {"time": "dense", "resolution": "1ms"},
            )
            for semantics in ("standard", "boolean")
        ]
        own = [{key: data[key] for key in ("time", *spec.input_names)} for spec in specs]
        expected = [spec.evaluate(d) for spec, d in zip(specs, own, strict=True)]
        same(rtamt.evaluate_all(specs, data), expected)


def test_dense_signals_begin_and_end_with_what_each_requirement_reads():
    data = {
        "x": [[0.0, 1.0], [2.0, 5.0], [9.0, 4.0]],
        "y": [[1.0, 3.0], [4.0, 0.0]],
        "z": [[0.5, 3.0], [20.0, 0.0]],
    }
    texts = ("once[0:1](x >= 3)", "always(y >= 1)", "x >= 2 and y >= 1", "z >= 1 or x >= 3", "x <= 7")
    specs = [rtamt.parse(text, time="dense") for text in texts]
    expected = [spec.evaluate({name: data[name] for name in spec.input_names}) for spec in specs]
    same(rtamt.evaluate_all(specs, data), expected)


@settings(max_examples=60)
@given(st.data())
def test_law_missing_and_uncertain_samples_give_the_bounds_that_each_gives_alone(data):
    formulas = data.draw(st.lists(strategies.formulas(), min_size=1, max_size=3))
    specs = [*(rtamt.parse(str(formula)) for formula in formulas), rtamt.parse("x >= 0")]
    trace = data.draw(strategies.traces(tuple(dict.fromkeys(name for s in specs for name in s.input_names))))
    gaps = st.sets(st.integers(0, len(trace["x"]) - 1), max_size=3)
    whole = {"time": np.arange(len(trace["x"]), dtype=float)}
    for name in trace:
        missing = data.draw(gaps)
        whole[name] = [None if i in missing else float(value) for i, value in enumerate(trace[name])]
    uncertain = data.draw(st.sampled_from([None, {"x": 0.5}, {"x": 2.0}]))
    limits = data.draw(st.sampled_from([None, {"x": (-1e9, 1e9)}]))
    time = data.draw(st.sampled_from(["discrete", "dense"]))
    expected, wrong = [], None
    for spec in specs:
        own = {key: whole[key] for key in ("time", *spec.input_names)}
        of_x = {"uncertainty": uncertain, "ranges": limits} if "x" in spec.input_names else {}
        try:
            expected.append(spec.evaluate(own, time=time, **of_x))
        except rtamt.StlError as error:
            wrong = error
            break
    if wrong is not None:
        with pytest.raises(rtamt.StlError):
            rtamt.evaluate_all(specs, whole, time=time, uncertainty=uncertain, ranges=limits)
        return
    found = rtamt.evaluate_all(specs, whole, time=time, uncertainty=uncertain, ranges=limits)
    for one, other in zip(found, expected, strict=True):
        assert one.interval == other.interval
        for each in ("times", "lower", "upper"):
            assert np.array_equal(getattr(one.intervals, each), getattr(other.intervals, each))


def test_wrong_data_stay_an_error_beside_missing_samples():
    specs = [rtamt.parse("always(x >= 3)"), rtamt.parse("always(y >= 1)")]
    with pytest.raises(rtamt.TraceError, match=r"^'y' is NaN at sample 1"):
        rtamt.evaluate_all(specs, {"x": [5, None], "y": [1, float("nan")]})
    with pytest.raises(rtamt.TraceError, match=r"^'[xy]' has [12] and '[xy]' has [12] samples"):
        rtamt.evaluate_all(specs, {"x": [5, 4], "y": [1]})  # each alone fits
    with pytest.raises(rtamt.UsageError, match=r"^uncertainty= has 'z', and the formula reads x, y$"):
        rtamt.evaluate_all(specs, {"x": [5, 4], "y": [1, 2]}, uncertainty={"z": 1})


def test_one_result_of_many_is_like_any_other():
    specs = [rtamt.parse("low = x <= 3; always(low)"), rtamt.parse("once(y >= 3)")]
    first, second = rtamt.evaluate_all(specs, {"x": [1, 5], "y": [0, 4]})
    assert first["low"].values.tolist() == [2, -2]
    assert first.explain().critical.predicate == "x <= 3"
    with pytest.raises(rtamt.UsageError, match=r"^'x' reads 'x', which the formula does not"):
        second["x"]


def test_no_requirements_give_no_results():
    assert rtamt.evaluate_all([], {"x": [1]}) == []


def test_a_requirement_that_does_not_fit_is_named_by_its_number():
    specs = [rtamt.parse("always[0:1](x >= 3)"), rtamt.parse("always[0:500ms](x >= 3)")]
    with pytest.raises(rtamt.BoundError) as caught:
        rtamt.evaluate_all(specs, {"time": [0, 1], "x": [1, 2]})
    assert caught.value.message.startswith("specification 1: ")
    assert caught.value.message.endswith(
        "(the period was taken from the timestamps; period=, or on the command line --period, sets it)"
    )
    with pytest.raises(rtamt.SpecificationError, match=r"^specification 0: 'prev' means one sample away"):
        rtamt.evaluate_all([rtamt.parse("prev(x >= 3)")], {"time": [0, 1], "x": [1, 2]}, time="dense")
