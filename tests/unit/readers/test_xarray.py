"""``rtamt.read`` of xarray: coordinates, and values that are encoded."""

import numpy as np
import pytest
import xarray as xr

import rtamt

X = [5.0, 4.0, 6.0]
STAMPS = [0.0, 0.1, 0.2]


def test_dimensions_of_a_dataset_are_clocks_of_their_own():
    data = xr.Dataset(
        {
            "x": ("time", [1.0, 2.0], {"units": "V"}),
            "y": ("t", [1, 2, 3]),
            "image": (("time", "t"), np.zeros((2, 3))),
        },
        coords={"time": [0.0, 1.0], "t": [0, 1, 2]},
    )
    trace = rtamt.read(data)
    assert (trace["x"].times.tolist(), trace["y"].times.tolist()) == ([0, 1], [0, 1, 2])
    assert (trace.channel("x").unit, trace.notes) == ("V", ("left out, not one-dimensional: image",))


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_data_of_xarray_is_not_evaluated_without_its_coordinates(time):
    data = xr.Dataset({"x": ("time", X)}, {"time": ("time", [0, 500, 1000], {"units": "ms"})})
    spec = rtamt.parse("always[0:1](x >= 5)", time=time)
    for given, kind in ((data, "Dataset"), (data["x"], "DataArray")):
        for evaluate in (spec.evaluate, spec.monitor().update_many):
            with pytest.raises(rtamt.TraceError) as error:
                evaluate(given)
            assert str(error.value) == f"expected data, got an xarray {kind}; write rtamt.read(data)"
    assert spec.evaluate(rtamt.read(data)).robustness == -1


def test_timestamps_of_xarray_are_found_in_every_coordinate_of_a_dimension():
    data = xr.Dataset({"x": ("row", X)}, {"time": ("row", STAMPS)})
    assert rtamt.read(data)["x"].times.tolist() == STAMPS
    with pytest.raises(rtamt.TraceError, match="has a column that may hold the timestamps: 'row'"):
        rtamt.read(xr.Dataset({"x": ("row", X)}, {"row": STAMPS}))
    assert rtamt.read(xr.Dataset({"x": ("row", X)}, {"row": [7, 8, 9]})).channel("x").times is None


@pytest.mark.parametrize(
    ("variable", "attributes", "problem", "decoded"),
    [
        ("x", {"scale_factor": 0.01}, "the attribute 'scale_factor'", [0.01, 0.9, 0.02]),
        ("x", {"add_offset": 1}, "the attribute 'add_offset'", [2, 91, 3]),
        ("x", {"_FillValue": 90}, "the attribute '_FillValue'", [1, 2]),
        ("x", {"missing_value": 90}, "the attribute 'missing_value'", [1, 2]),
        ("time", {"units": "minutes since 2026-05-01"}, "the unit 'minutes since 2026-05-01'", [1, 90, 2]),
    ],
)
def test_encoded_values_of_xarray_are_rejected_and_decoded_ones_read(variable, attributes, problem, decoded):
    data = xr.Dataset({"x": ("time", [1, 90, 2])}, coords={"time": [0, 1, 2]})
    data[variable].attrs.update(attributes)
    for encoded in (data, data["x"]):
        with pytest.raises(rtamt.TraceError) as error:
            rtamt.read(encoded)
        assert str(error.value) == (
            f"'{variable}' of an xarray dataset has {problem}, so that its values are not decoded: read "
            f"xarray.decode_cf(dataset)"
        )
    assert rtamt.read(xr.decode_cf(data))["x"].values.tolist() == decoded
