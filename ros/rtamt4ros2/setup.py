"""How colcon installs the node: ``ros2 run rtamt4ros2 ros_stl_monitor``."""

from setuptools import setup

PACKAGE = "rtamt4ros2"

setup(
    name=PACKAGE,
    version="1.0.0",
    packages=[PACKAGE],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/launch", ["launch/monitor.launch.py"]),
    ],
    install_requires=["setuptools", "rtamt"],
    entry_points={"console_scripts": [f"ros_stl_monitor = {PACKAGE}.ros_stl_monitor:main"]},
)
