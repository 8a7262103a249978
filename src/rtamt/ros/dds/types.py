"""Convert message definitions to classes for Cyclone DDS: those of ROS 2, ``rtamt_msgs``, and custom ones."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices
from rtamt.extras import library, message_package
from rtamt.ros.message_definitions import DEFINITIONS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.ros.binding import MessageType

#: The default ROS 2 distribution, unless ``ROS_DISTRO`` is set.
DISTRO = "jazzy"
#: Environment variables with package folders; for the first one below ``share``.
_PATHS = (("AMENT_PREFIX_PATH", "share"), ("ROS_PACKAGE_PATH", ""))


class Types:
    """The message types of one distribution of ROS 2.

    ``distro``: such as ``"humble"``. ``folders``: where packages with definitions of the user's own are
    (``<folder>/<package>/msg/<Name>.msg``), besides those that the environment names. Raises
    :class:`UsageError` if the distribution is unknown, or the packages are not installed.
    """

    def __init__(self, distro: str | None = None, folders: Sequence[str] = ()) -> None:
        self._typesys = library("rosbags.typesys", "reading message definitions", "ros")
        self._idl = library("cyclonedds.idl", "speaking to ROS 2", "ros")
        name = distro or os.environ.get("ROS_DISTRO") or DISTRO
        known = [s.name.removeprefix("ROS2_").lower() for s in self._typesys.Stores if "ROS2" in s.name]
        if name not in known:
            source = "" if distro else " (from the environment variable ROS_DISTRO)"
            raise UsageError(
                f"unknown distribution '{name}' of ROS 2{source}{choices(name, known, 'distributions')}"
            )
        self._store = self._typesys.get_typestore(self._typesys.Stores[f"ROS2_{name.upper()}"])
        self._folders = [Path(folder) for folder in folders] + _folders()
        self._classes: dict[str, Any] = {}
        self._names: dict[Any, str] = {}
        for own, text in DEFINITIONS.items():
            if own not in self._store.fielddefs:
                self._store.register(self._typesys.get_types_from_msg(text, own))

    def load(self, kind: MessageType) -> Any:
        """Return the class of a type as a specification imports it: ``from nav_msgs.msg import Odometry``."""
        return self.named(f"{message_package(kind.module, kind.name)}/msg/{kind.name}")

    def named(self, name: str) -> Any:
        """Return the class of a type by its full name, ``nav_msgs/msg/Odometry``; call it for a message of zeros."""
        if name not in self._classes:
            self._find(name)
            made = self._classes[name] = self._make(name)
            self._names[made] = name
        return self._classes[name]

    def type_hash(self, cls: Any) -> str:
        """Return the hash of a class of :meth:`named`: ``RIHS01_...``, as ROS 2 computes it since Iron."""
        return str(self._store.hash_rihs01(self._names[cls]))

    def _find(self, name: str) -> None:
        """Register a definition and all definitions that it needs."""
        if name not in self._store.fielddefs:
            package, _, short = name.split("/")
            paths = [folder / package / "msg" / f"{short}.msg" for folder in self._folders]
            found = next((path for path in paths if path.is_file()), None)
            if found is None:
                raise UsageError(
                    f"the definition of {package}/{short} is not known: name the folder in which the package "
                    f"'{package}' is with --messages"
                )
            self._store.register(self._read(found, name))
        for _, field in self._store.fielddefs[name][1]:
            inner = self._field_class(field)
            if inner is not None:
                self._find(inner)

    def _read(self, path: Path, name: str) -> Any:
        text = path.read_text(encoding="utf-8")
        if re.search(r"^\s*wstring\b", text, re.MULTILINE):  # which rosbags takes for the name of a message
            raise _unsupported_error("wstring")
        try:
            return self._typesys.get_types_from_msg(text, name)
        except self._typesys.TypesysError as error:
            place = "".join(str(error).splitlines()[3:4])  # after what is wrong, the text and a position
            raise UsageError(f"'{path}' is not a message definition of ROS: '{place}' is no field") from None

    def _field_class(self, field: Any) -> str | None:
        node, what = field
        kinds = self._typesys.base.Nodetype
        if node == kinds.NAME:
            return str(what)
        return None if node == kinds.BASE else self._field_class(what[0])

    def _make(self, name: str) -> Any:
        package, _, short = name.split("/")
        fields = {field: self._type(desc) for field, desc in self._store.fielddefs[name][1]}
        # A message without fields still takes one byte on the wire.
        shapes = {field: shape for field, (shape, _) in fields.items()} or {
            "structure_needs_at_least_one_member": self._idl.types.uint8
        }
        made = self._idl.make_idl_struct(short, f"{package}::msg::dds_::{short}_", shapes)
        zeros = {field: zero for field, (_, zero) in fields.items()} or dict.fromkeys(shapes, int)
        return _with_zeros(made, zeros)

    def _type(self, field: Any) -> tuple[Any, Callable[[], Any]]:
        """Return the IDL type of a field, and a factory of its zero value."""
        node, what = field
        types, kinds = self._idl.types, self._typesys.base.Nodetype
        if node == kinds.NAME:
            inner = self.named(what)
            return inner, inner
        if node == kinds.BASE:
            return self._base(*what)
        shape, zero = self._type(what[0])
        if node == kinds.ARRAY:
            return types.array[shape, what[1]], lambda: [zero() for _ in range(what[1])]
        return (types.sequence[shape, what[1]] if what[1] else types.sequence[shape]), list

    def _base(self, base: str, most: int) -> tuple[Any, Callable[[], Any]]:
        if base == "string":
            return (self._idl.types.bounded_str[most] if most else str), str
        if base == "bool":
            return bool, bool
        known = getattr(
            self._idl.types, {"byte": "uint8", "octet": "uint8", "char": "uint8"}.get(base, base), None
        )
        if known is None:
            raise _unsupported_error(base)
        return known, float if base.startswith("float") else int


def _unsupported_error(base: str) -> UsageError:
    return UsageError(
        f"a message with a field of type {base} cannot be read or sent over DDS: Cyclone DDS for Python has no such "
        f"type; change the field to string, or use the node for rclpy (ros/rtamt4ros2)"
    )


def _folders() -> list[Path]:
    return [
        Path(folder) / below
        for variable, below in _PATHS
        for folder in os.environ.get(variable, "").split(os.pathsep)
        if folder
    ]


def _with_zeros(made: Any, zeros: dict[str, Callable[[], Any]]) -> Any:
    """Give all fields of a class default values, as in ROS's own classes."""
    original = made.__init__

    def start(self: Any, **given: Any) -> None:
        if len(given) < len(zeros):
            given = {name: given[name] if name in given else zero() for name, zero in zeros.items()}
        original(self, **given)

    made.__init__ = start
    return made
