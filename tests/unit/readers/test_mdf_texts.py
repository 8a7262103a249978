"""Channels of MDF files whose conversions have texts for some numbers, or for all."""

import asammdf
import numpy as np
import pytest
from asammdf.blocks.conversion_utils import from_dict

import rtamt

#: 0.4 * raw - 40 degrees, and two codes for what is no temperature.
SCALED = {"a": 0.4, "b": -40.0}
TABLE = {"val_0": 254, "text_0": b"not available", "val_1": 255, "text_1": b"error", "default_addr": SCALED}
RANGES = {
    "lower_0": 0, "upper_0": 253, "text_0": SCALED,
    "lower_1": 254, "upper_1": 254, "text_1": b"not available",
    "lower_2": 255, "upper_2": 255, "text_2": b"error",
}  # fmt: skip
NESTED = {
    "lower_0": 0, "upper_0": 253, "text_0": SCALED,
    "lower_1": 254, "upper_1": 255, "text_1": {"val_0": 254, "text_0": b"not available", "default_addr": b"error"},
}  # fmt: skip
SWITCH = {"val_0": 0, "text_0": b"off", "val_1": 1, "text_1": b"on"}


def recording(path, raw, conversion, **more):
    with asammdf.MDF(version=more.pop("version", "4.10")) as file:
        times = np.arange(float(len(raw)))
        file.append(
            [asammdf.Signal(np.array(raw), times, name="x", conversion=from_dict(dict(conversion)), **more)]
        )
        return file.save(path, overwrite=True)


def values(path, **options):
    return rtamt.read(path, **options)["x"].values.tolist()


@pytest.mark.parametrize("conversion", [TABLE, RANGES, NESTED], ids=["table", "ranges", "nested"])
@pytest.mark.parametrize("length", [3, 400])
@pytest.mark.parametrize("dtype", ["u1", "f8"])
def test_a_scaled_channel_whose_samples_are_all_texts_has_no_numbers(tmp_path, conversion, length, dtype):
    """They were the raw codes 255, so that `x <= 100` was violated by -155; asammdf has another case from 100 on."""
    if dtype == "f8" and conversion is not TABLE:
        conversion = {name: value + 0.5 if "upper" in name else value for name, value in conversion.items()}
    raw = np.full(length, 255, dtype)
    path = recording(tmp_path / "a.mf4", raw, conversion)
    assert np.isnan(values(path)).all()
    assert rtamt.read(path).losses == (
        f"{length} samples of x are NaN, because its conversion maps them to texts such as 'error'; declare x as an "
        f"enumeration to read them",
    )
    raw[1] = 100
    mixed = values(recording(tmp_path / "b.mf4", raw, conversion))
    assert mixed[1] == 0
    assert np.isnan(mixed).sum() == length - 1
    raw[2:] = 100
    assert rtamt.read(recording(tmp_path / "c.mf4", raw, conversion)).losses == (
        "1 sample of x is NaN, because its conversion maps it to the text 'error'; declare x as an enumeration to "
        "read it",
    )
    with pytest.raises(rtamt.TraceError, match="'x' is NaN at sample 0"):
        rtamt.parse("always(x <= 100)").evaluate(rtamt.read(path))


def test_texts_of_samples_that_the_file_marks_as_invalid_are_missing(tmp_path):
    flags = np.array([False, True, False])
    path = recording(tmp_path / "a.mf4", np.array([100, 255, 110], "u1"), TABLE, invalidation_bits=flags)
    trace = rtamt.read(path)
    assert trace["x"].values.tolist() == [0, 4]
    assert trace.losses == ()


def test_without_a_text_a_scaled_channel_has_no_note(tmp_path):
    trace = rtamt.read(recording(tmp_path / "a.mf4", np.array([100, 110], "u1"), TABLE))
    assert trace["x"].values.tolist() == [0, 4]
    assert trace.losses == ()


def test_texts_of_a_scaled_channel_are_left_out_with_skip_nan_and_read_by_name(tmp_path):
    path = recording(tmp_path / "a.mf4", np.array([100, 255, 110], "u1"), TABLE)
    assert values(path, skip_nan=["x"]) == [0, 4]
    types = rtamt.parse("enum State { ok, error = 7 } State x  x == error").types
    assert values(path, types=types)[1] == 7


@pytest.mark.parametrize("version", ["3.30", "4.10"])
@pytest.mark.parametrize("conversion", [SWITCH, {**SWITCH, "default_addr": b"undefined"}])
def test_an_enumeration_is_read_as_raw_codes(tmp_path, version, conversion):
    suffix = "mdf" if version == "3.30" else "mf4"
    path = recording(tmp_path / f"a.{suffix}", np.array([0, 1, 7], "u1"), conversion, version=version)
    assert values(path) == [0, 1, 7]
    assert rtamt.read(path).losses == ()


def test_an_enumeration_whose_table_leads_to_another_one_is_read_as_raw_codes(tmp_path):
    conversion = {"val_0": 0, "text_0": b"off", "default_addr": {"val_0": 1, "text_0": b"on"}}
    assert values(recording(tmp_path / "a.mf4", np.array([0, 1, 7], "u1"), conversion)) == [0, 1, 7]
