"""Monitor Signal Temporal Logic: compute the robustness of requirements on recorded or live signals."""

__version__ = "1.0.0.dev0"


def _modules() -> dict[str, str]:
    """Return each public name with the module that defines it, from the stub: they are listed there alone."""
    with open(f"{__file__}i", encoding="utf-8") as stub_file:
        imports = stub_file.read().split("\nfrom ")[
            1:
        ]  # of one name each; to import `ast` takes longer than the rest
    parts = [statement.partition(" import ") for statement in imports]
    return {names.lstrip("(\n ").partition(" as ")[0]: module for module, _, names in parts}


def __getattr__(name: str) -> object:
    """Return a public name, which is imported on first use; so is the list of these names."""
    from rtamt.lazy import attributes

    modules = _modules()
    module = globals()
    module["__all__"] = sorted(modules)
    module["__getattr__"] = attributes(__name__, modules)
    return module["__all__"] if name == "__all__" else module["__getattr__"](name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_modules()})
