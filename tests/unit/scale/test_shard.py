"""A shard: what each sample leads to does not depend on batches, and wrong samples affect their key alone."""

from math import isnan, nan

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


def feed(batches, lateness=None):
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
    single = feed([each] for each in given)
    assert len(single[1]) > 40
    assert {each[2] for each in single[1]} == {True, False}
    assert feed([given]) == single
    assert feed([given[:7], given[7:300], [], given[300:]]) == single


def test_what_is_left_equals_offline_robustness():
    given = samples()
    results, rejected = feed([given])
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
    results, rejected = feed(([each] for each in given), "4s")
    rejected.sort()
    assert len(results) > 50
    assert {position < 0 for position, _, _ in rejected} == {True, False}
    for batches in ([given], [given[:7], given[7:300], [], given[300:]]):
        found = feed(batches, "4s")
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
    assert [result[1:3] for result in results] == known
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


def test_each_requirement_of_a_suite_has_its_results():
    suite = rtamt.Suite(rtamt.parse("require LOW: always[0:1](x <= 9); require ROOT: sqrt(y) >= 1"))
    shard = Shard(suite)
    taken = shard.take(
        [Sample("a", 0.0, (4.0, 9.0)), Sample("a", 1.0, (12.0, -1.0)), Sample("a", 1.0, (5.0, 4.0))]
    )
    assert taken.results == [
        Result("a", 0.0, 2.0, "ROOT"),
        Result("a", 0.0, 4.0, "LOW"),
        Result("a", 1.0, 1.0, "ROOT"),
    ]
    assert [each.position for each in taken.rejected] == [1]


def test_late_samples_of_a_suite_are_released_by_requirement():
    suite = rtamt.Suite(rtamt.parse("require A: x >= 3; require B: x <= 7"))
    shard = Shard(suite, lateness=2)
    first = shard.take([Sample("a", float(t), (float(t),)) for t in (0, 2, 1)])
    again = Shard(suite, lateness=2, state=shard.snapshot()).take([Sample("a", 4.0, (4.0,))])
    assert first.results == [Result("a", 0.0, -3.0, "A"), Result("a", 0.0, 7.0, "B")]
    assert again.results == [
        Result("a", t, v, n) for t in (1.0, 2.0) for n, v in (("A", t - 3), ("B", 7 - t))
    ]


@pytest.mark.parametrize("several", [False, True])
def test_dense_time_takes_samples_of_some_variables(several):
    text = "require A: always[0:1](x >= 3); require B: y >= 3" if several else "x >= 3 or y >= 3"
    spec = rtamt.parse(text, time="dense")
    given = [(0.0, 4.0, 2.0), (0.5, nan, 5.0), (2.5, 1.0, nan), (2.0, 1.0, nan), (3.0, nan, 1.0)]
    found = []
    for some in ([given], [[each] for each in given]):
        shard, results, rejected = Shard(rtamt.Suite(spec) if several else spec), [], []
        for batch in some:
            taken = shard.take([Sample("a", time, values) for time, *values in batch])
            results += taken.results
            rejected += [each.error for each in taken.rejected]
            shard = Shard(rtamt.Suite(spec) if several else spec, state=shard.snapshot())
        found.append((sorted(results, key=str), rejected))
    assert found[0] == found[1]
    assert len(found[0][1]) == 1
    expected = []
    for name, one in spec.requirements.items() if several else [(None, spec)]:
        monitor = one.monitor(time="dense")
        for time, x, y in (each for each in given if each[0] != 2.0):
            values = {n: v for n, v in (("x", x), ("y", y)) if not isnan(v) and n in one.input_names}
            known = monitor.update(time, **values)
            expected += [Result("a", *point, name) for point in zip(known.times, known.values, strict=True)]
    assert found[0][0] == sorted(expected, key=str)


def test_silent_keys_expire_in_whatever_batches_messages_come():
    spec = rtamt.parse("once[0:1](sqrt(x) >= 3)")
    samples = [
        *(Sample("a", float(t), (16.0,)) for t in (0, 2, 1, 3)),
        Sample("b", 0.0, (1.0,)),
        Sample("c", 0.0, (-1.0,)),
        Sample("b", 1.0, (1.0,)),
        Sample("a", 4.0, (25.0,)),
        Sample("a", 5.0, (25.0,)),
        Sample("d", 0.0, (4.0,)),
    ]
    arrivals = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 62.0, 63.5, nan, 200.0]
    found = []
    for size in (1, 3, 10):
        shard, results, expired, discarded = Shard(spec, lateness=2, expire_after=60), [], [], []
        for first in range(0, 10, size):
            taken = shard.take(samples[first : first + size], arrivals[first : first + size])
            results += taken.results
            expired += taken.expired
            discarded += [(each.key, each.time) for each in taken.discarded]
            shard = Shard(spec, lateness=2, expire_after=60, state=shard.snapshot())
        found.append((sorted(results), sorted(expired), discarded))
        assert len(shard) == 1
    assert found[0] == found[1] == found[2]
    results, expired, discarded = found[0]
    assert expired == ["a", "a", "b", "c"]
    assert discarded == [("c", 0.0)]
    # What waited of "a" was released before it was forgotten; then its trace started again.
    assert [(each.time, each.robustness) for each in results if each.key == "a"] == [
        *((t, 1.0) for t in (0.0, 1.0, 2.0, 3.0)),
        (4.0, 2.0),
        (5.0, 2.0),
    ]


@pytest.mark.parametrize("size", [1, 2, 6])
def test_a_new_key_takes_the_place_of_an_expired_one_in_whatever_batches_messages_come(size):
    samples = [Sample(key, 0.0, (4.0,)) for key in ("a", "b", "c", "d", "c", "e")]
    arrivals = [0.0, 50.0, 55.0, 61.0, 120.0, 122.0]
    spec = rtamt.parse("x >= 3")
    shard, results, rejected, expired = Shard(spec, capacity=2, expire_after=60), [], [], []
    for first in range(0, 6, size):
        taken = shard.take(samples[first : first + size], arrivals[first : first + size])
        results += [each.key for each in taken.results]
        rejected += [first + each.position for each in taken.rejected]
        expired += taken.expired
    assert results == ["a", "b", "d", "c", "e"]
    assert (rejected, expired, len(shard)) == ([2], ["a", "b", "d"], 2)


def test_a_state_goes_on_with_and_without_expiry():
    plain = Shard(SPEC)
    plain.take([Sample("a", 0.0, (4.0,))])
    begun = Shard(SPEC, state=plain.snapshot(), expire_after=60)
    assert begun.take([Sample("b", 1.0, (4.0,))], [1e9]).expired == []
    assert begun.take([Sample("b", 2.0, (4.0,))], [1e9 + 61]).expired == ["b", "a"]
    ended = Shard(SPEC, state=begun.snapshot())
    assert len(ended) == 1
    assert ended.take([Sample("b", 3.0, (4.0,)), Sample("b", 4.0, (4.0,))]).results == [Result("b", 2.0, 1.0)]


@pytest.mark.parametrize("place", range(0, 60, 3))
def test_a_damaged_state_with_expiry_is_refused(place):
    shard = Shard(SPEC, expire_after=60)
    shard.take([Sample("a", 0.0, (4.0,))], [5.0])
    state = bytearray(shard.snapshot())
    state[place] ^= 4
    with pytest.raises(rtamt.UsageError, match=r"^this is not the state of a fleet"):
        Shard(SPEC, expire_after=60, state=bytes(state))


def test_what_no_fleet_monitors_is_an_error_at_once():
    with pytest.raises(rtamt.UsageError) as caught:
        Shard(rtamt.parse("x >= 3", time="dense"), lateness=2)
    assert str(caught.value) == (
        "lateness needs discrete time, and this is dense time: send the samples of a key in the order of their times"
    )
    with pytest.raises(rtamt.UsageError, match=r"^the formula quantifies over 'cars'"):
        Shard(rtamt.parse('group cars = "car_*"; forall v in cars: v.x > 5'))
    text = 'input float v = "speed"; v <= 30', 'enum Mode { OFF, ON }; input Mode m = "speed"; m == ON'
    with pytest.raises(rtamt.UsageError) as caught:
        Shard(rtamt.Suite([rtamt.parse(each, time="dense") for each in text]))
    assert str(caught.value) == (
        "'speed' has different declarations in the requirements of the suite: declare it alike"
    )
