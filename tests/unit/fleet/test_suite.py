"""``rtamt.Suite``: names, selection, what specifications can do, bytes."""

from __future__ import annotations

import pickle
import struct
import zlib

import numpy as np
import pytest

import rtamt
from rtamt.compiler import plan, time_lowering
from rtamt.extend import STL, Fixity, Operator, Sort
from rtamt.language.parsing import lexer
from rtamt.verdicts import preparation, prepared

TYPED = """
    enum Mode { MANUAL, AUTO = 4 }
    parameter float limit = 4
    input Mode mode
    input bool armed
    input float v [m/s] = "drive.speed" or "speed"
    optional input float battery [V]
    require AUTO: always(mode == AUTO -> armed)
    require SPEED "slow enough" severity warning: always(v <= limit)
    require BAT: always(battery >= 14)
"""
DATA = {"time": [0.0, 1.0, 2.0], "mode": ["AUTO", "MANUAL", "AUTO"], "armed": [True, False, False]}


def rows(suite, data, **more):
    return [tuple(row[1:]) for row in suite.evaluate(data, **more)]


def both(specs, **settings):
    """Return a suite, and the same read from bytes."""
    suite = rtamt.Suite(specs, **settings)
    return suite, pickle.loads(pickle.dumps(suite))


def test_types_parameters_recorded_names_units_and_optional_signals_are_kept():
    spec = rtamt.parse(TYPED, period=1)
    data = {**DATA, "speed": [3, 5, 2]}
    for suite in both(spec):
        assert rows(suite, data) == [
            ("AUTO", -np.inf, False, 2.0, None, None),
            ("SPEED", -1.0, False, 1.0, None, None),
            ("BAT", None, None, None, "not checked: no 'battery'", None),
        ]
    for suite in both(spec.with_parameters(limit=6)):
        assert rows(suite, {**data, "battery": [15, 15, 15]})[1:] == [
            ("SPEED", 1.0, True, None, None, None),
            ("BAT", 1.0, True, None, None, None),
        ]
    trace = rtamt.read({"time": [0.0, 1.0], "speed": [3.6, 36.0]}, units={"speed": "km/h"})
    for suite in both(spec.select("SPEED")):
        assert rows(suite, trace) == [("SPEED", -6.0, False, 1.0, None, None)]


def test_requirements_are_named_by_id_specification_or_text():
    parse = rtamt.parse
    suite = rtamt.Suite(
        [parse("require A: x >= 1; require B: x >= 2"), parse("specification slow x >= 3"), parse("x >= 4")]
    )
    assert [each.name for each in suite.requirements] == ["A", "B", "slow", "x >= 4"]
    suite = rtamt.Suite([parse("x >= 1"), parse("x >= 1")])
    assert [each.name for each in suite.requirements] == ["x >= 1 (1)", "x >= 1 (2)"]
    suite = rtamt.Suite({"low": parse("x >= 1"), "two": parse("require A: x >= 1; require B: x >= 2")})
    assert [each.name for each in suite.requirements] == ["low", "two: A", "two: B"]
    known = rtamt.Suite(parse(TYPED)).requirements[1]
    assert (known.formula, known.description, known.severity) == ("always(v <= 4)", "slow enough", "warning")


def test_what_is_not_selected_is_not_computed():
    spec = rtamt.parse("always(x >= 3)", period=1)
    data = {"x": [5, 2]}
    robustness, verdict, when = (
        rtamt.Suite([spec], select=[name]) for name in ("robustness", "satisfied", "first_violation")
    )
    assert rows(robustness, data) == [("always(x >= 3)", -1.0, None, None, None, None)]
    assert rows(verdict, data) == [("always(x >= 3)", None, False, None, None, None)]
    assert rows(when, data) == [("always(x >= 3)", None, None, 1.0, None, None)]
    both_ = rtamt.Suite([spec])

    def instructions(suite):
        ((_, one),) = suite._groups[0].programs(spec.period).parts
        return (
            sum(len(program.instructions) for program in one.robustness.programs()) if one.robustness else 0
        )

    assert instructions(robustness) < instructions(both_)
    assert robustness.evaluate(data).columns == (
        "recording",
        "requirement",
        "robustness",
        "unchecked",
        "error",
    )
    assert verdict.evaluate(data).to_numpy().dtype.names == (
        "recording",
        "requirement",
        "satisfied",
        "unchecked",
        "error",
    )


def test_programs_are_split_where_registers_exceed_the_cache(monkeypatch):
    specs = [
        rtamt.parse(f"always(once[0:{i + 1}](x >= {i}) -> eventually[0:{i + 2}](y >= {i}))", period=1)
        for i in range(12)
    ]
    random = np.random.default_rng(1)
    data = {"x": random.normal(6, 4, 50), "y": random.normal(6, 4, 50)}
    whole = rtamt.Suite(specs)
    table = whole.evaluate(data)
    monkeypatch.setattr(preparation, "REGISTERS", 20)
    split = rtamt.Suite(specs)
    assert split.evaluate(data) == table == rtamt.Suite.from_bytes(split.to_bytes()).evaluate(data)
    assert len(whole._groups[0].programs(specs[0].period).parts) == 1
    parts = split._groups[0].programs(specs[0].period).parts
    assert len(parts) > 1
    for _, part in parts:
        assert (
            all(preparation._registers(program) <= 20 for program in part.robustness.programs())
            or len(part) == 1
        )


def test_signals_that_exceed_memory_are_computed_in_portions(monkeypatch):
    specs = [rtamt.parse(f"always(x >= {i} -> eventually[0:2](x <= {i}))", period=1) for i in range(9)]
    data = {"x": np.random.default_rng(2).normal(4, 3, 64)}
    table = rtamt.Suite(specs).evaluate(data)
    monkeypatch.setattr(prepared, "ROOM", 64 * 4)
    suite = rtamt.Suite(specs)
    assert suite.evaluate(data) == table
    assert len(suite._groups[0].programs(specs[0].period).parts[0][1]._parts) > 1


def test_each_requirement_samples_by_its_own_rule():
    held = rtamt.parse("sample 1 s hold for 3 s; input float x; input float y; always(x + y >= 3)")
    plain = rtamt.parse("always(x >= 3)", time="dense")
    data = {"x": ([0.0, 0.4, 2.0], [5.0, 1.0, 4.0]), "y": ([0.5, 2.5], [3.0, -3.0])}
    for suite in both([held, plain]):
        for row, spec in zip(suite.evaluate(data), (held, plain), strict=True):
            result = spec.evaluate(data)
            assert row[2:5] == (result.robustness, result.satisfied, rtamt.first_violation(result))


def test_members_custom_operators_and_the_definition_are_evaluated_by_themselves_and_not_stored():
    group = rtamt.parse('group cars = "car_*"; require GAP: always forall v in cars: v.x > 3', period=1)
    plain = rtamt.parse("always(x >= 3)", period=1)
    defined = rtamt.parse("always(x >= 4)", period=1, backend="python")
    data = {"x": [5, 4], "car_1.x": [4, 5], "car_2.x": [9, 2]}
    suite = rtamt.Suite([group, plain, defined])
    assert [row.robustness for row in suite.evaluate(data)] == [-1.0, 1.0, 0.0]
    with pytest.raises(rtamt.UsageError) as caught:
        suite.to_bytes()
    assert str(caught.value) == (
        "the requirement 'GAP' cannot be stored with a suite: it quantifies over the members of 'cars', which each "
        "recording decides; leave it out, and evaluate it by itself"
    )
    with pytest.raises(rtamt.UsageError, match=r"it is evaluated by backend='python'; leave it out"):
        pickle.dumps(rtamt.Suite(defined))
    over = group.over({"cars": ["car_1", "car_2"]})
    for one in both(over):
        assert one.evaluate(data).rows[0].robustness == -1.0


def test_a_custom_operator_is_evaluated_by_itself_and_not_stored():
    between = Operator(
        *(
            "between",
            ("between",),
            Fixity.FUNCTION,
            200,
            (Sort.NUMBER,) * 3,
            Sort.NUMBER,
            "Held.",
            "between(x, 0, 1)",
        ),
        definition=lambda x, low, high: x.clip(low, high),
    )
    spec = rtamt.parse("always(between(x, 0, 1) >= 0.5)", language=STL.extend(between), period=1)
    suite = rtamt.Suite([spec, rtamt.parse("always(x >= 3)", period=1)])
    assert [row.robustness for row in suite.evaluate({"x": [5, 2]})] == [0.5, -1.0]
    with pytest.raises(
        rtamt.UsageError, match=r"it uses the operator 'between', whose code bytes cannot carry; "
    ):
        suite.to_bytes()


def test_a_missing_sample_is_an_error_of_the_requirements_that_read_it():
    specs = [rtamt.parse("always(x >= 3)", period=1), rtamt.parse("always(y >= 3)", period=1)]
    for suite in both(specs):
        first, second = suite.evaluate({"x": [5, None], "y": [5, 4]})
        assert first.error.startswith("'x' ")
        assert second.robustness == 1.0


def test_a_period_that_each_recording_decides_is_not_stored():
    suite = rtamt.Suite(rtamt.parse("always[0:1](x >= 3)"))
    with pytest.raises(rtamt.UsageError) as caught:
        suite.to_bytes()
    assert str(caught.value) == (
        "the requirement 'always[0:1](x >= 3)' cannot be stored with a suite: it has no sampling period, in which its "
        "bounds are counted; give one, such as Suite(specs, period='100ms')"
    )
    row = suite.evaluate({"time": [0, 2, 4], "x": [1, 2, 3]}).rows[0]
    assert (
        "(the period was taken from the timestamps; period=, or on the command line --period, sets it)"
        in row.error
    )


def test_one_wrong_signal_is_the_error_of_the_requirements_that_read_it():
    specs = [rtamt.parse(text, period=1) for text in ("always(x >= 3)", "always(y >= 1)", "always(z >= 0)")]
    for suite in both(specs):
        table = suite.evaluate({"x": [5, float("nan")], "y": [1, 2]}, recording="a.csv")
        assert [row.error for row in table] == [
            "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out",
            None,
            "the data has no 'z'; signals: x, y",
        ]
        assert [row.recording for row in table] == ["a.csv"] * 3
        assert table.rows[1][2:5] == (0.0, True, None)


@pytest.mark.parametrize("name", ["robustness", "satisfied", "first_violation"])
def test_an_undefined_value_concerns_one_requirement_whatever_is_selected(name):
    specs = [rtamt.parse(text, period=1) for text in ("true", "always(x / y >= 1)", "always(x >= 0)")]
    for suite in both(specs, select=[name]):
        table = suite.evaluate({"x": [1, 0], "y": [1, 0]})
        assert [row.error is None for row in table] == [True, False, True]
        expected = {"robustness": [np.inf, None, 0.0], "satisfied": [True, None, True]}
        assert [getattr(row, name) for row in table] == expected.get(name, [None] * 3)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_verdicts_alone_are_those_of_boolean_semantics(time, backend):
    texts = ("always(x >= y)", "always(x - y >= 0)", "always(x * 0 == 0)")
    period = 1 if time == "discrete" else None
    specs = [rtamt.parse(text, time=time, period=period, backend=backend) for text in texts]
    data = {"time": [5, 6], "x": [np.inf, 1], "y": [np.inf, 1]}
    table = rtamt.Suite(specs, select=["satisfied", "first_violation"]).evaluate(data)
    assert table.rows[0][2:] == (None, True, None, None, None)
    assert specs[0].evaluate(data, semantics="boolean").satisfied
    for spec, row in zip(specs[1:], table.rows[1:], strict=True):
        with pytest.raises(rtamt.EvaluationError, match=r"has no value at (sample 0, )?time 5 s: ") as error:
            spec.evaluate(data, semantics="boolean")
        assert (row.satisfied, row.error) == (None, str(error.value))


def test_first_violations_are_numbers_in_the_times_of_the_recording():
    suite = rtamt.Suite(rtamt.parse("always(x >= 3)", period=1))
    start = np.datetime64("2024-05-01T10:00:00", "ns")
    dates = start + np.arange(3) * np.timedelta64(1, "s")
    (row,) = suite.evaluate({"time": dates, "x": [5, 4, 2]})
    assert row.first_violation == 1714557602.0
    (row,) = rtamt.Suite(rtamt.parse("always(x >= 3)", period=1), time_unit="ms").evaluate(
        {"time": [0, 1000, 2000], "x": [5, 1, 2]}
    )
    assert row.first_violation == 1000


def test_the_table_as_arrays_and_as_arrow():
    suite = rtamt.Suite([rtamt.parse("always(x >= 3)", period=1), rtamt.parse("always(y >= 3)", period=1)])
    table = suite.evaluate({"x": [5, 2]}, recording="a")
    array = table.to_numpy()
    assert array["satisfied"].tolist() == [0, -1]
    assert array["robustness"][0] == -1
    assert np.isnan(array["robustness"][1])
    arrow = table.to_arrow()
    assert arrow.column_names == list(table.columns)
    assert arrow["satisfied"].to_pylist() == [False, None]
    assert arrow["first_violation"].to_pylist() == [1.0, None]
    assert arrow["error"].to_pylist() == [None, table.rows[1].error]
    assert repr(table) == "<2 verdicts of 1 recordings, 1 errors>"


def test_pyarrow_is_imported_only_where_a_table_of_arrow_is_asked_for():
    import subprocess
    import sys

    program = """
import sys
sys.modules["pyarrow"] = None
import rtamt
table = rtamt.Suite(rtamt.parse("always(x >= 3)", period=1)).evaluate({"x": [5]})
print(table.to_numpy()["robustness"])
try:
    table.to_arrow()
except rtamt.UsageError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [
        "[2.]",
        "the table of a suite needs the package 'pyarrow', which is not installed: pip install 'rtamt[data]'",
    ]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda _: rtamt.Suite([]), "a suite needs one specification or more"),
        (
            lambda _: rtamt.Suite("x >= 3"),
            "a suite takes specifications, got 'x >= 3'; rtamt.parse reads text",
        ),
        (
            lambda _: rtamt.Suite(["x >= 3"]),
            "a suite takes specifications, got 'x >= 3'; rtamt.parse reads text",
        ),
        (
            lambda spec: rtamt.Suite(spec, select="robustness"),
            "select is the text 'robustness'; give a list of names, such as ['robustness']",
        ),
        (
            lambda spec: rtamt.Suite(spec, select=["robustnes"]),
            "a suite cannot select 'robustnes'; did you mean 'robustness'? (columns: robustness, satisfied, "
            "first_violation)",
        ),
        (
            lambda spec: rtamt.Suite(spec, select=[]),
            "a suite selects nothing: give one or more of robustness, satisfied, first_violation",
        ),
    ],
)
def test_wrong_arguments(make, message):
    with pytest.raises(rtamt.UsageError) as caught:
        make(rtamt.parse("x >= 3", period=1))
    assert str(caught.value) == message


def test_a_bound_that_is_no_multiple_of_the_period_names_the_requirement():
    with pytest.raises(rtamt.BoundError, match=r"^SLOW: "):
        rtamt.Suite(rtamt.parse("require SLOW: always[0:500ms](x >= 3)"), period=1)


# ---- bytes ---------------------------------------------------------------------------------------


CODE = rtamt.Suite(
    [
        rtamt.parse("always(x >= 3 -> eventually[0:2](y >= 1))", period=1),
        rtamt.parse("x / y >= 1", period=1),
        rtamt.parse("always(x >= 3) until (y >= 1)", time="dense"),
    ]
).to_bytes()


def test_loading_parses_and_compiles_nothing(monkeypatch):
    def never(*_given, **_more):
        raise AssertionError("text is parsed, or a formula compiled")

    data = {"time": [0.0, 1.0], "x": [4, 5], "y": [2, 0.5]}
    expected = rtamt.Suite.from_bytes(CODE).evaluate(data)
    monkeypatch.setattr(lexer.Tokens, "__init__", never)
    monkeypatch.setattr(time_lowering, "lowering_of", never)
    monkeypatch.setattr(plan, "lowering_of", never)
    found = rtamt.Suite.from_bytes(CODE).evaluate(data)
    assert found == expected
    assert [row.error for row in found] == [None] * 3
    with pytest.raises(AssertionError, match=r"^text is parsed"):
        rtamt.parse("x >= 71")


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (b"", "it does not begin with 'RTAMTSTE'"),
        (b"RTAMTPRG" + CODE[8:], "it does not begin with 'RTAMTSTE'"),
        (CODE[:8] + b"\x07" + CODE[9:], "its format has version 7, and this is for version 1"),
        (CODE[:40] + b"?" + CODE[41:], "its checksum does not match, so it was damaged on the way"),
        (CODE[:-9], "its checksum does not match, so it was damaged on the way"),
    ],
)
def test_damaged_bytes(code, reason):
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Suite.from_bytes(code)
    assert str(caught.value) == f"this is not a suite that can be read: {reason}"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"step":"1"', b'"step":"1e999999999"'),
        (b'"step":"1"', b'"step":"0"'),
        (b'"settled":0', b'"settled":9223372036854775807'),
        (b'"settled":0', b'"settled":true'),
        (b'"numbers":[0,1]', b'"numbers":[0,0]'),
        (b'"domain":"dense"', b'"domain":"discrete"'),
        (b'"leaves":"robustness"', b'"leaves":null'),
        (b'"names":["x","y"]', b'"names":["x","z"]'),
        (b'"select":["robustness","satisfied"', b'"select":["satisfied","satisfied"'),
    ],
)
def test_a_listing_that_lies_is_rejected_with_a_sentence(old, new):
    assert old in CODE
    length = struct.unpack_from("<I", CODE, 12)[0]
    listing = CODE[16 : 16 + length].replace(old, new)
    code = CODE[:12] + struct.pack("<I", len(listing)) + listing + CODE[16 + length :]
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Suite.from_bytes(resealed(code))
    assert "\n" not in str(caught.value)


def test_something_else_than_bytes():
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Suite.from_bytes("suite")
    assert str(caught.value) == "expected the bytes of a suite, as to_bytes() returns them, got 'suite'"


def resealed(code):
    body = bytes(code)[:-4]
    return body + struct.pack("<I", zlib.crc32(body))


def test_bytes_changed_on_purpose_are_rejected_or_evaluated():
    """The checksum is right, so that everything else has to be verified."""
    rejected = 0
    for seed in range(300):
        random = np.random.default_rng(seed)
        code = bytearray(CODE)
        for _ in range(random.integers(1, 4)):
            at = random.integers(8, len(code) - 4)
            code[at] = random.integers(256) if seed % 2 else ord(random.choice(list('0123456789[]{},":-')))
        try:
            suite = rtamt.Suite.from_bytes(resealed(code))
        except rtamt.UsageError:
            rejected += 1
            continue
        assert len(suite.evaluate({"time": [0.0, 1.0], "x": [4, 5], "y": [2, 0.5]})) == len(suite)
    assert 100 < rejected < 300
