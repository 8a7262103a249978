"""A fleet of the C API against one of Python: the same reports and errors, and each reads the other's snapshots."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, SpecificationError, TraceError
from rtamt.language.printing.printer import to_text
from tests.laws.fleet_batches import MODES, NUMBERS, Mode, columns_of, draw_batch, draw_fleet
from tests.laws.test_fleet_monitor_laws import of_fleet
from tests.support.c_api import REFUSED, UNDEFINED
from tests.support.c_fleet import CFleet, RejectedError, Report
from tests.support.strategies import formulas

#: The modes of the other law without settings that are for Python alone, and records.
OWN = {
    **{name: mode for name, mode in MODES.items() if name not in ("delayed", "interval with corrections")},
    "records": Mode(False, False, False, {}),
}


def of_c_fleet(fleet: CFleet, report: Report) -> list[Any]:
    """Return what an update has of each sample as plain values, as ``of_fleet`` does."""
    rows: dict[int, list[Any]] = {}
    for index, begin, end, lower, upper, decided_at, is_final in report.rows:
        if fleet.mode == "eager":
            assert lower == upper
            row = (begin, end, lower > 0, decided_at)
        elif fleet.mode == "interval":
            row = (begin, end, lower, upper, bool(is_final), False)
        else:
            assert (begin, lower) == (end, upper)
            row = (begin, lower)
        rows.setdefault(index, []).append(row)
    if fleet.mode == "interval":
        return [
            [*values, late, rows.get(index, [])]
            for index, (values, late) in enumerate(zip(report.values, report.late, strict=True))
        ]
    if fleet.mode == "causation":
        return [list(values) for values in report.values]
    return [rows.get(index, []) for index in range(len(report.values))]


def attempted(fleet: rtamt.Fleet[Any], *batch: Any) -> tuple[Any, Exception | None]:
    """Return the update of a batch, or why it is rejected."""
    try:
        return fleet.update_many(*batch), None
    except (TraceError, EvaluationError) as error:
        return None, error


@pytest.mark.parametrize("mode", OWN)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_fleet_in_c_is_one_of_python(mode: str, data: st.DataObject) -> None:
    drawn = draw_fleet(data, OWN[mode])
    spec, made = drawn.spec, drawn.settings
    fleet = rtamt.Fleet(spec, 3, **made)
    program = fleet.compile()
    ranges = made.get("ranges", {})
    in_c = CFleet(program, 3, ranges=ranges)
    assert set(in_c.inputs) == set(spec.input_names)
    every = data.draw(st.sampled_from([[3, -1, 2**40], ["a", "Ä\U0001f600", "long-" * 9]]))
    clocks = dict.fromkeys(every, drawn.start)
    for _ in range(data.draw(st.integers(2, 5))):
        keys, times, rows, ahead = draw_batch(data, drawn, every, clocks, fleet)
        if made.get("ranges") and data.draw(st.integers(0, 4)) == 4:
            rows[-1] = {**rows[-1], "x": 50.0}
        columns = {name: [row.get(name, ...) for row in rows] for name in spec.input_names}
        update, refused = attempted(fleet, keys, times, columns_of(spec.input_names, rows))
        if refused is not None:
            with pytest.raises(RejectedError) as rejected:
                in_c.update(keys, times, columns)
            status, _, index = rejected.value.args
            assert status == (UNDEFINED if isinstance(refused, EvaluationError) else REFUSED)
            assert f" at index {index} of the batch" in str(refused)
        else:
            clocks = ahead
            found = in_c.update(keys, times, columns)
            if mode == "records":
                pairs = zip(update.values.tolist(), update.known, strict=True)
                known = [value if is_known else None for value, is_known in pairs]
                assert [value for (value,) in found.values] == known
            else:
                assert of_c_fleet(in_c, found) == of_fleet(update, keys)
        assert sorted(in_c.keys()) == sorted(fleet.keys())
        assert in_c.late == fleet.late
        if len(fleet) and data.draw(st.booleans()):
            gone = data.draw(st.sampled_from(sorted(fleet.keys())))
            fleet.drop([gone])
            in_c.drop([gone])
        if data.draw(st.booleans()):
            before = drawn.start + data.draw(st.sampled_from([0.5, 1.5, 3.0])) * drawn.step
            assert in_c.expire(before) == fleet.expire(before=before)
        if data.draw(st.booleans()):
            exchanged = fleet.snapshot(), in_c.snapshot()
            in_c = CFleet(program, 0, state=exchanged[0], ranges=ranges)
            fleet = rtamt.Fleet.restore(spec, exchanged[1], **made)
    assert sorted(in_c.keys()) == sorted(fleet.keys())


WITH_WATERMARK = (
    "interval",
    "interval with late samples",
    "interval dense",
    "interval dense with late samples",
    "causation dense",
)


@pytest.mark.parametrize("mode", WITH_WATERMARK)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_watermark_in_c_is_one_of_python(mode: str, data: st.DataObject) -> None:
    dense, _, _, made = OWN[mode]
    spec = rtamt.parse(
        to_text(data.draw(formulas(max_depth=3, discrete=not dense))), time="dense" if dense else "discrete"
    )
    names = spec.input_names
    assume(names)
    made = {name: value for name, value in made.items() if name != "ranges"}
    try:
        fleet = rtamt.Fleet(spec, 3, **made)
    except SpecificationError:
        assume(False)
    in_c = CFleet(fleet.compile(), 3)
    time = 0.0
    for _ in range(data.draw(st.integers(1, 5))):
        time += data.draw(st.sampled_from([1.0, 1.0, 2.0])) if dense else 1.0
        columns = {name: [data.draw(NUMBERS)] * 2 for name in names}
        try:
            update = fleet.update_many([1, 2], [time, time], columns)
        except (TraceError, EvaluationError):
            with pytest.raises(RejectedError):
                in_c.update([1, 2], [time, time], columns)
            continue
        assert of_c_fleet(in_c, in_c.update([1, 2], [time, time], columns)) == of_fleet(update, [1, 2])
        mark = time + data.draw(st.sampled_from([-1.0, 0.0]))
        try:
            update = fleet.watermark(mark)
        except EvaluationError:
            with pytest.raises(Exception, match="no value"):
                in_c.watermark(mark)
            continue
        assert of_c_fleet(in_c, in_c.watermark(mark)) == of_fleet(update, in_c.keys())
        if data.draw(st.booleans()):
            in_c = CFleet(fleet.compile(), 0, state=fleet.snapshot())
