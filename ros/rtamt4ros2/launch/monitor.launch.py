"""ros2 launch rtamt4ros2 monitor.launch.py spec:=/path/to/spec.stl period:=100ms (or time:=dense)."""

from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from launch import LaunchDescription

#: Arguments and what holds where nothing is said.
ARGUMENTS = {
    "period": "",
    "unit": "s",
    "time": "discrete",
    "stale": "",
    "verdict": "",
    "at": "",
    "set": "",
    "reliability": "reliable",
    "durability": "volatile",
}


def generate_launch_description():
    """Return the monitor's node."""
    names = ["spec", *ARGUMENTS]
    values = {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name in names}
    values["use_sim_time"] = ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)
    declared = [DeclareLaunchArgument("spec"), DeclareLaunchArgument("use_sim_time", default_value="false")]
    declared += [DeclareLaunchArgument(name, default_value=value) for name, value in ARGUMENTS.items()]
    node = Node(package="rtamt4ros2", executable="ros_stl_monitor", output="screen", parameters=[values])
    return LaunchDescription([*declared, node])
