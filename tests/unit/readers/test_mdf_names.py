"""Names of the channels of MDF files whose groups, or channels, have one name."""

import asammdf
import numpy as np
import pytest

import rtamt

TIMES = np.arange(3.0)


def recording(path, *groups):
    """Each group: its acquisition name, and its channels with the first of three values."""
    with asammdf.MDF(version="4.10") as file:
        for name, channels in groups:
            signals = [asammdf.Signal(first + TIMES, TIMES, name=channel) for channel, first in channels]
            file.append(signals, acq_name=name)
        return file.save(path)


def first_values(path, **options):
    trace = rtamt.read(path, **options)
    return {name: trace[name].values[0] for name in trace.names}


def test_groups_of_one_name_are_read(tmp_path):
    """Their masters have one name, too, so that the file had "2 columns called 'CAN1.time'"."""
    path = recording(tmp_path / "a.mf4", ("CAN1", [("speed", 1)]), ("CAN1", [("torque", 5)]))
    assert first_values(path) == {"speed": 1, "torque": 5}
    assert first_values(path, columns=["torque"]) == {"torque": 5}


def test_channels_of_one_name_in_groups_of_one_name_have_the_number_of_their_group(tmp_path):
    path = recording(
        tmp_path / "a.mf4",
        ("CAN1", [("speed", 1), ("gear", 2)]),
        ("CAN1", [("speed", 5)]),
        ("CAN2", [("gear", 7)]),
    )
    named = {"CAN1[0].speed": 1, "CAN1.gear": 2, "CAN1[1].speed": 5, "CAN2.gear": 7}
    assert first_values(path) == named
    assert first_values(path, columns=["v"], names={"v": "CAN1[1].speed"}) == {"v": 5}


def test_a_name_of_several_channels_is_an_error_with_the_choices(tmp_path):
    path = recording(tmp_path / "a.mf4", ("CAN1", [("v", 1)]), ("CAN1", [("v", 5), ("torque", 2)]))
    assert first_values(path, columns=["torque"]) == {"torque": 2}
    with pytest.raises(rtamt.TraceError) as caught:
        rtamt.read(path, columns=["v"])
    assert str(caught.value) == (
        f"{path} has no column 'v'; columns: CAN1[0].time, CAN1[0].v, CAN1[1].time, CAN1[1].v, torque"
    )


def test_channels_of_one_name_in_one_group_are_both_read(tmp_path):
    path = recording(tmp_path / "a.mf4", ("CAN1", [("v", 1), ("v", 5), ("time", 9)]))
    assert first_values(path) == {"CAN1[0].v[0]": 1, "CAN1[0].v[1]": 5, "CAN1[0].time[1]": 9}
    assert rtamt.read(path)["CAN1[0].v[1]"].times.tolist() == TIMES.tolist()
