import sys
from types import ModuleType

import pytest

from tests.unit.compat.messages import Message


@pytest.fixture(autouse=True)
def messages(monkeypatch):
    """Provide the package of messages that texts import."""
    module = ModuleType("some_msgs")
    module.Message = Message
    monkeypatch.setitem(sys.modules, "some_msgs", module)
    monkeypatch.setitem(sys.modules, "some_msgs.msg", module)
