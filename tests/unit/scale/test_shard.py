"""A shard: what each sample leads to does not depend on batches, and wrong samples affect their key alone."""

import numpy as np
import pytest

import rtamt
from rtamt.scale.shard import Result, Sample, Shard

SPEC = rtamt.parse("always[0:2](sqrt(x) <= 3)")


def samples():
    """Return samples of eight keys: some late, some without a value, some with NaN, some after a gap."""
    random = np.random.default_rng(1)
    found = []
    for i in range(600):
        time = float(i // 8)
        value = float(random.uniform(0, 16))
        key = f"car-{random.integers(8)}"
        if i % 41 == 0:
            time -= 3
        if i % 37 == 0:
            value = float("nan")
        if i % 43 == 0:
            value = -1.0
        found.append(Sample(key, time, (value,)))
    return found


def taken_in(batches, lateness=None):
    shard, results, rejected, at = Shard(SPEC, lateness=lateness), [], [], 0
    for batch in batches:
        taken = shard.take(batch)
        results += taken.results
        rejected += [(at + each.position, each.error, each.late) for each in taken.rejected]
        rejected += [(-1, each.error, False) for each in taken.discarded]
        at += len(batch)
        shard = Shard(SPEC, state=shard.snapshot(), lateness=lateness)
    return results, rejected


def test_results_and_rejections_do_not_depend_on_batches():
    given = samples()
    single = taken_in([each] for each in given)
    assert len(single[1]) > 40
    assert {each[2] for each in single[1]} == {True, False}
    assert taken_in([given]) == single
    assert taken_in([given[:7], given[7:300], [], given[300:]]) == single


def test_what_is_left_equals_offline_robustness():
    given = samples()
    results, rejected = taken_in([given])
    wrong = {index for index, _, _ in rejected}
    expected = set()
    for key in {sample.key for sample in given}:
        own = [each for i, each in enumerate(given) if each.key == key and i not in wrong]
        traces: list[list[Sample]] = []
        for each in own:
            if traces and each.time - traces[-1][-1].time == 1:
                traces[-1].append(each)
            else:
                traces.append([each])
        for trace in traces:
            if len(trace) < 3:
                continue
            times = [each.time for each in trace]
            robustness = SPEC.evaluate({"time": times, "x": [each.values[0] for each in trace]}).signal
            expected |= {
                Result(key, t, r) for t, r in zip(times, robustness.values, strict=True) if t <= times[-1] - 2
            }
    assert set(results) == expected
    assert len(results) == len(expected) > 50


def test_samples_that_wait_do_not_depend_on_batches():
    given = samples()
    results, rejected = taken_in(([each] for each in given), "4s")
    rejected.sort()
    assert len(results) > 50
    assert {position < 0 for position, _, _ in rejected} == {True, False}
    for batches in ([given], [given[:7], given[7:300], [], given[300:]]):
        found = taken_in(batches, "4s")
        assert sorted(found[0]) == sorted(results)
        assert sorted(found[1]) == rejected


def test_a_sample_without_a_value_neither_loses_those_that_wait_nor_doubles_results():
    shard = Shard(rtamt.parse("sqrt(x) <= 3"), lateness="3s")
    values = [4.0, 1.0, -1.0, 9.0, 16.0, 4.0, 4.0, 4.0, 4.0]
    given = [Sample("a", float(t), (x,)) for t, x in enumerate(values)]
    taken = [shard.take([each]) for each in [*given[:6], *given]]
    results = [(each.time, each.robustness) for one in taken for each in one.results]
    assert results == [(0.0, 1.0), (1.0, 2.0), (3.0, 0.0), (4.0, -1.0), (5.0, 1.0)]
    assert [(each.key, each.time) for one in taken for each in one.discarded] == [("a", 2.0)]
    (error,) = (each.error for one in taken for each in one.discarded)
    assert error.startswith("key 'a', a sample that waited: 'sqrt(x)' has no value")
    again = [one.rejected for one in taken[6:]]
    assert [[each.late for each in some] for some in again] == [[True]] * 2 + [[False]] + [[True]] * 3 + [
        []
    ] * 3


def test_samples_in_any_order_have_the_results_of_those_in_order():
    random = np.random.default_rng(4)
    values = random.uniform(0, 16, 60).tolist()
    shard, results = Shard(SPEC, lateness="5s"), []
    order = sorted(range(60), key=lambda i: i + random.uniform(0, 5))
    assert order != sorted(order)
    taken = [shard.take([Sample("a", float(i), (values[i],))]) for i in order]
    assert not any(each.rejected for each in taken)
    results = [result for each in taken for result in each.results]
    signal = SPEC.evaluate({"time": np.arange(60.0), "x": values}).signal
    known = list(zip(signal.times.tolist(), signal.values.tolist(), strict=True))[: len(results)]
    assert [result[1:] for result in results] == known
    assert len(results) > 50
    (late,) = shard.take([Sample("a", 7.0, (1.0,))]).rejected
    assert (late.late, late.error) == (
        True,
        "key 'a': the sample at 7 s is late: one that is newer by the lateness has come, or one of the same time",
    )


def test_messages_name_the_key():
    shard = Shard(rtamt.parse("sqrt(x) >= 3"), capacity=2)
    wrong = [
        Sample("a", 0.0, (1.0,)),
        Sample("a", 0.0, (1.0,)),
        Sample("a", 1.0, (-1.0,)),
        Sample("a", 1.0, (float("nan"),)),
        Sample("b", float("inf"), (1.0,)),
        Sample("b", 7.0, (1.0,)),
        Sample("c", 0.0, (1.0,)),
    ]
    rejected = shard.take(wrong).rejected
    assert [(each.position, each.late) for each in rejected] == [
        (1, True),
        (2, False),
        (3, False),
        (4, False),
        (6, False),
    ]
    assert rejected[0].error == (
        "key 'a': time does not increase at sample 1: 0 s comes after 0 s; "
        "sort the samples and drop repeated timestamps"
    )
    assert rejected[1].error.startswith("key 'a': 'sqrt(x)' has no value at sample 1, time 1 s")
    assert rejected[4].error.startswith("key 'c' is new, and the fleet has its 2 keys already")


def test_a_robustness_of_zero_does_not_decide():
    found = Shard(rtamt.parse("x >= 3")).take(
        [Sample("a", float(i), (float(x),)) for i, x in enumerate((4, 3, 2))]
    )
    assert [result.satisfied for result in found.results] == [True, None, False]
    found = Shard(rtamt.parse("x >= 3", semantics="boolean")).take([Sample("a", 0.0, (3.0,))])
    assert [result.satisfied for result in found.results] == [True]


def test_what_no_fleet_monitors_is_an_error_at_once():
    with pytest.raises(rtamt.UsageError, match=r"^gaps='restart' needs delayed verdicts in discrete time"):
        Shard(rtamt.parse("x >= 3", time="dense"))
