"""The packages in ros/ without ROS: what they import of rtamt is there."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest

ROS = Path(__file__).parents[3] / "ros"
NODES = ("rtamt4ros/scripts/ros_stl_monitor.py", "rtamt4ros2/rtamt4ros2/ros_stl_monitor.py")


@pytest.mark.parametrize("node", NODES)
def test_a_node_imports_what_is_there(node):
    tree = ast.parse((ROS / node).read_text())
    ours = [
        statement
        for statement in ast.walk(tree)
        if isinstance(statement, ast.ImportFrom) and (statement.module or "").split(".")[0] == "rtamt"
    ]
    assert ours
    for statement in ours:
        module = importlib.import_module(statement.module)
        missing = [alias.name for alias in statement.names if not hasattr(module, alias.name)]
        assert missing == [], f"{statement.module} has no {missing}"
