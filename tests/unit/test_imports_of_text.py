"""What the text of a specification may import: message classes of message packages, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from types import ModuleType

import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.ros import MessageType
from rtamt.ros.dds.types import Types

NO_MESSAGE = " of 'our_msgs.msg' is no message class; a specification imports nothing but those"
PACKAGES_ONLY = "a specification imports from message packages only, such as std_msgs.msg, and not "


class Number:
    """A message class as rclpy makes them."""

    made = 0

    def __init__(self):
        type(self).made += 1
        self.value = 0.0

    @classmethod
    def get_fields_and_field_types(cls):
        """Return the types of the fields."""
        return {"value": "double"}


class Bystander:
    """A class that lies in a module of messages by chance."""

    made = 0

    def __init__(self):
        type(self).made += 1
        self.value = 0.0


@pytest.fixture(autouse=True)
def modules(monkeypatch):
    module = ModuleType("our_msgs.msg")
    module.Number, module.Bystander, module.call, module.LIMIT = Number, Bystander, sys.exit, 3
    monkeypatch.setitem(sys.modules, "our_msgs.msg", module)
    monkeypatch.setitem(sys.modules, "our_things", module)
    Number.made = Bystander.made = 0


def parsed(text, *code_imports, cls=rtamt.StlDiscreteTimeSpecification):
    spec = cls()
    for module, name in code_imports:
        spec.import_module(module, name)
    spec.spec = text
    spec.parse()
    return spec


REFUSED = [
    ("code", "interact", PACKAGES_ONLY + "'interact' from 'code'"),
    ("os", "system", PACKAGES_ONLY + "'system' from 'os'"),
    ("os.path", "exists", PACKAGES_ONLY + "'exists' from 'os.path'"),
    ("our_things", "Number", PACKAGES_ONLY + "'Number' from 'our_things'"),
    ("a.b.msg", "F", PACKAGES_ONLY + "'F' from 'a.b.msg'"),
    ("../a.msg", "F", PACKAGES_ONLY + "'F' from '../a.msg'"),
    ("our_msgs.msg", "Bystander", "'Bystander'" + NO_MESSAGE),
    ("our_msgs.msg", "call", "'call'" + NO_MESSAGE),
    ("our_msgs.msg", "LIMIT", "'LIMIT'" + NO_MESSAGE),
    ("our_msgs.msg", "Numbr", "'our_msgs.msg' has no 'Numbr'; did you mean 'Number'?"),
]  # fmt: skip


@pytest.mark.parametrize(("module", "name", "sentence"), REFUSED)
def test_text_imported_any_module_and_called_any_class_in_it(module, name, sentence):
    with pytest.raises(UsageError) as caught:
        MessageType(module, name).load()
    assert str(caught.value) == sentence
    text = f'from "{module}" import {name}  input {name} x  x.value >= 3'
    if "/" not in module:
        text = text.replace('"', "")
        with pytest.raises(rtamt.RTAMTException) as said:
            parsed(text)
        way_in = f" (import_module('{module}', '{name}') before parse() imports any class)"
        assert str(said.value) == f"RTAMT Exception: {sentence}{way_in}"
    assert Bystander.made == 0


def test_a_prompt_opened_when_a_text_imported_code_interact():
    """In a process of its own: a prompt would have read the standard input."""
    program = (
        "import rtamt; s = rtamt.StlDiscreteTimeSpecification(); "
        "s.spec = 'from code import interact input interact x x >= 3'; s.parse()"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], input="print('a' + 'live')\n", capture_output=True, text=True, check=False
    )  # fmt: skip
    assert done.returncode == 1
    assert "and not 'interact' from 'code'" in done.stderr
    assert "alive" not in done.stdout


def test_definitions_for_dds_are_of_message_packages_only():
    pytest.importorskip("cyclonedds")
    for module, name in (("../../x.msg", "F"), ("a.b.msg", "F"), ("os", "system")):
        with pytest.raises(UsageError, match="imports from message packages only"):
            Types().load(MessageType(module, name))
    with pytest.raises(UsageError, match=r"cannot be the name of a message class in 'a\.msg'"):
        Types().load(MessageType("a.msg", "../../secret"))


@pytest.mark.parametrize("cls", [rtamt.StlDiscreteTimeSpecification, rtamt.StlDenseTimeSpecification])
def test_text_imports_messages_and_whatever_code_has_imported_before(cls):
    text = "from {} import {kind}  input {kind} x  x.value >= 3"
    assert parsed(text.format("our_msgs.msg", kind="Number"), cls=cls).free_vars == {"x"}
    assert Number.made
    opened = parsed(text.format("our_things", kind="Bystander"), ("our_things", "Bystander"), cls=cls)
    assert opened.free_vars == {"x"}
    assert Bystander.made


def test_a_text_that_names_python_itself_as_a_field_changes_no_class():
    for field in ("__class__.made", "__class__"):
        with pytest.raises(rtamt.RTAMTException, match="has no field '__class__"):
            parsed(
                f"from our_msgs.msg import Number  input Number x  output Number y  y.{field} = x.value >= 3"
            )
        with pytest.raises(UsageError, match="is no path of fields"):
            rtamt.ros.bind(rtamt.parse(
                f"from our_msgs.msg import Number  input Number x  output Number y  y.{field} = x.value >= 3"
            ))  # fmt: skip
    assert isinstance(Number.made, int)


@pytest.fixture
def package(tmp_path):
    """Make a package of messages that leaves a mark when it is imported; return its folder."""
    folder = tmp_path / "evil"
    folder.mkdir()
    (folder / "__init__.py").write_text("open('mark', 'w').close()\n")
    (folder / "msg.py").write_text(
        "class F:\n"
        "    value = 0.0\n"
        "    def get_fields_and_field_types(): return {'value': 'double'}\n"
    )  # fmt: skip
    return folder


def test_a_message_package_in_the_current_directory_ran_when_a_text_named_it(package):
    program = (
        "import sys; {first}import rtamt; s = rtamt.StlDiscreteTimeSpecification(); "
        "s.spec = 'from evil.msg import F input F x x.value >= 3'; s.parse(); print('read')"
    )

    def run(folder, first=""):
        return subprocess.run(
            [sys.executable, "-c", program.format(first=first)], cwd=folder, capture_output=True, text=True, check=False
        )  # fmt: skip

    here = package.parent
    done = run(here)
    assert "the message package 'evil' lies in the current directory" in done.stderr
    assert done.returncode == 1
    assert not (here / "mark").exists()
    # By choice: on the path of modules, or imported by code.
    elsewhere = here / "elsewhere"
    elsewhere.mkdir()
    assert run(elsewhere, f"sys.path.append({str(here)!r}); ").stdout == "read\n"
    assert run(here, "import evil.msg; ").stdout == "read\n"


@pytest.mark.parametrize("is_package", [True, False])
def test_a_module_without_messages_ran_when_a_text_looked_for_messages_in_it(
    package, monkeypatch, is_package
):
    (package / "msg.py").unlink()
    if not is_package:
        (package.parent / "evil.py").write_text((package / "__init__.py").read_text())
        (package / "__init__.py").unlink()
    monkeypatch.syspath_prepend(package.parent)
    monkeypatch.chdir(package)
    with pytest.raises(UsageError, match="'evil' is no message package: it has no module 'msg'"):
        MessageType("evil.msg", "F").load()
    assert not (package / "mark").exists()


def test_a_message_package_may_have_its_messages_in_another_folder(package, monkeypatch, tmp_path):
    (tmp_path / "over" / "evil").mkdir(parents=True)
    (tmp_path / "over" / "evil" / "__init__.py").write_text(
        "from pkgutil import extend_path\n__path__ = extend_path(__path__, __name__)\n"
    )
    for folder in (package.parent, tmp_path / "over"):
        monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "evil", raising=False)
    monkeypatch.chdir(package)
    assert MessageType("evil.msg", "F").load().value == 0.0
    for name in ("evil", "evil.msg"):
        monkeypatch.delitem(sys.modules, name)
