"""Modules without files: RTAMT spreads few names over deep folders, and programs import them from there."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


def provide(package: str, modules: Mapping[str, Mapping[str, Any]]) -> None:
    """Make names importable from modules below a package: from the path of each module to its names."""
    for path, names in modules.items():
        parent = sys.modules[package]
        for step in path.split("."):
            name = f"{parent.__name__}.{step}"
            module = sys.modules.setdefault(
                name, ModuleType(name, "Provide names under RTAMT's module path.")
            )
            setattr(parent, step, module)
            parent = module
        vars(parent).update(names)
