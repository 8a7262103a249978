"""The variables of a requirement, from observations, actions and infos."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from rtamt.errors import TraceError, UsageError, choices, shown
from rtamt.lazy.modules import np

#: Where a variable is found: ``("observation", 2)``, ``("info", "speed")``, ``("action",)``.
Path: TypeAlias = tuple[Any, ...]
#: A function of observation, action and info, or a path for each variable.
Source: TypeAlias = Callable[[Any, Any, Any], Mapping[str, Any] | None] | Mapping[str, Path]

ROOTS = ("observation", "action", "info")


class SignalReader:
    """Reads one sample, or a batch of them, from what an environment returns.

    The action is None for the sample of a reset. If a path starts at the action, or if the function returns None, that
    sample is left out: the trace starts with the first step.

    >>> read = SignalReader({"x": ("observation", 1), "u": ("action",)}, ("x", "u"))
    >>> read([4, 5], 7, {}), read([4, 5], None, {})
    ({'x': 5, 'u': 7}, None)
    """

    def __init__(self, signals: Source, names: tuple[str, ...], *, batched: bool = False) -> None:
        self._function = None if isinstance(signals, Mapping) else signals
        self._paths: dict[str, Path] = {}
        self._batched = batched
        if isinstance(signals, Mapping):
            missing = [name for name in names if name not in signals]
            if missing:
                raise UsageError(
                    f"signals has no entry for the variable {shown(missing[0])} of the requirement"
                )
            self._paths = {name: _path(name, signals[name]) for name in names}
        elif not callable(signals):
            raise UsageError(
                f"signals is {shown(signals)}, expected a function of observation, action and info, or a path such as "
                f'("observation", 0) for each variable'
            )
        self._reads_action = any(path[0] == "action" for path in self._paths.values())

    def __call__(
        self, observation: Any, action: Any, info: Any, rows: Any = None
    ) -> Mapping[str, Any] | None:
        """Return the sample, or None for a reset without one.

        ``rows``: the environments of a batch that are read; infos may lack entries of others.
        """
        if self._function is not None:
            found = self._function(observation, action, info)
            if found is None:
                if action is not None:
                    raise TraceError(
                        "signals returned None for a step; only the sample of a reset may be left out"
                    )
                return None
            if not isinstance(found, Mapping):
                raise TraceError(
                    f"signals returned {shown(found)}, expected a mapping from variable to value"
                )
            return found
        if action is None and self._reads_action:
            return None
        roots = {"observation": observation, "action": action, "info": info}
        return {name: self._follow(name, roots, path, rows) for name, path in self._paths.items()}

    def _follow(self, name: str, roots: Mapping[str, Any], path: Path, rows: Any) -> Any:
        value, part = roots[path[0]], None
        try:
            for part in path[1:]:
                if (
                    value.__class__ is np.ndarray and self._batched
                ):  # first, because the other checks take longer
                    value = value[:, part]
                elif not self._batched or isinstance(value, Mapping | tuple):
                    self._require_all(name, value, part, rows)
                    value = value[part]
                else:
                    value = value[:, part]
        except (KeyError, IndexError, TypeError):
            raise TraceError(
                f"the variable {shown(name)} is not at {path}: there is no {shown(part)}", variable=name
            ) from None
        return value

    def _require_all(self, name: str, value: Any, part: Any, rows: Any) -> None:
        """Raise :class:`TraceError` where a batch of infos lacks an entry of an environment that is read."""
        if not self._batched or not isinstance(value, Mapping):
            return
        present = value.get(f"_{part}")
        if present is not None and not np.all(present[rows]):
            index = int(rows[np.argmin(present[rows])])
            raise TraceError(
                f"the variable {shown(name)} is missing: the info of environment {index} has no {shown(part)}",
                variable=name,
            )


def _path(name: str, given: Any) -> Path:
    path = (given,) if isinstance(given, str) else given
    if not isinstance(path, tuple) or not path or path[0] not in ROOTS:
        raise UsageError(
            f"the signal of {shown(name)} is {shown(given)}, expected a path such as "
            f'("observation", 0){choices(given, ROOTS, "first parts")}'
        )
    return path
