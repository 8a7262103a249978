"""Message types for Cyclone DDS, without a network."""

from __future__ import annotations

import pytest

from rtamt.errors import UsageError
from rtamt.ros.dds.types import Types


@pytest.fixture(scope="module", autouse=True)
def _cyclone() -> None:
    pytest.importorskip("cyclonedds", reason="ROS 2 topics need cyclonedds: pip install 'rtamt[ros]'")


@pytest.mark.parametrize(
    ("name", "known"),  # as `ros2 topic info --verbose` of ROS 2 Jazzy prints them
    [
        ("std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"),
        (
            "geometry_msgs/msg/Twist",
            "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
        ),
    ],
)
def test_the_hash_of_a_type_is_that_of_ros_2(name, known):
    types = Types("jazzy")
    assert types.type_hash(types.named(name)) == known


@pytest.mark.parametrize("field", ["wstring label", "wstring<=10 label", "wstring[] labels"])
def test_a_message_with_a_wstring_field_is_refused_with_a_sentence_that_names_a_remedy(tmp_path, field):
    (tmp_path / "arm_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "arm_msgs" / "msg" / "Label.msg").write_text(f"float64 value\n{field}\n")
    with pytest.raises(UsageError) as caught:
        Types("jazzy", [str(tmp_path)]).named("arm_msgs/msg/Label")
    assert str(caught.value) == (
        "a message with a field of type wstring cannot be read or sent over DDS: Cyclone DDS for Python has no such "
        "type; change the field to string, or use the node for rclpy (ros/rtamt4ros2)"
    )


def test_a_file_that_is_no_message_definition_is_refused_with_a_sentence(tmp_path):
    path = tmp_path / "arm_msgs" / "msg" / "Joint.msg"
    path.parent.mkdir(parents=True)
    path.write_text("float64 angle\nfloat64\n")
    with pytest.raises(UsageError) as caught:
        Types("jazzy", [str(tmp_path)]).named("arm_msgs/msg/Joint")
    assert str(caught.value) == f"'{path}' is not a message definition of ROS: 'float64' is no field"
