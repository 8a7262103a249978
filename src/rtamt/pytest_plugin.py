"""The plugin for pytest: the fixture ``stl``, explained failures with plots, and properties for JUnit reports.

pytest loads it where rtamt is installed. It imports nothing of rtamt before a test uses it.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from rtamt.assertions import UnsatisfiedError
    from rtamt.results import Result
    from rtamt.specification import Specification


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare where plots are written."""
    group = parser.getgroup("rtamt", "requirements in Signal Temporal Logic")
    group.addoption(
        "--stl-plots",
        metavar="FOLDER",
        help="write a plot of each violated requirement here (default: pytest's cache folder)",
    )


class Requirements:
    """The value of the fixture ``stl``."""

    def __init__(self, node: pytest.Item) -> None:
        self._node = node

    def load(self, path: str | os.PathLike[str], **settings: Any) -> Specification:
        """Load a specification file; a relative path starts in the folder of the test.

        The settings and errors are those of :func:`rtamt.load`.
        """
        import rtamt

        return rtamt.load(self._node.path.parent / path, **settings)

    def assert_satisfied(
        self,
        spec: Specification | str | os.PathLike[str],
        data: Any,
        *,
        margin: float = 0.0,
        **options: Any,
    ) -> Result:
        """Assert that requirements are satisfied, as :func:`rtamt.assert_satisfied` does.

        Robustness, verdict and first violation of each requirement become properties of the test, which JUnit
        reports contain (``pytest --junit-xml=FILE``). A relative path starts in the folder of the test.
        """
        __tracebackhide__ = True
        import os

        import rtamt
        from rtamt.assertions import UnsatisfiedError

        if isinstance(spec, os.PathLike):
            spec = self.load(spec)
        try:
            result = rtamt.assert_satisfied(spec, data, margin=margin, **options)
        except UnsatisfiedError as error:
            self._record(error.result)
            raise
        self._record(result)
        return result

    def _record(self, result: Result) -> None:
        from rtamt.assertions import facts

        properties = self._node.user_properties
        taken = {name for name, _ in properties}
        found = facts(result)
        number, suffix = 1, ""
        while any(f"rtamt.{name}{suffix}" in taken for name in found):
            number += 1
            suffix = f".{number}"  # a test may check the same requirement several times
        properties.extend((f"rtamt.{name}{suffix}", value) for name, value in found.items())


@pytest.fixture
def stl(request: pytest.FixtureRequest) -> Requirements:
    """Check requirements in Signal Temporal Logic: ``stl.assert_satisfied(spec, data)``, ``stl.load(path)``."""
    return Requirements(request.node)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Plot the requirements that a test found violated, and name the plots in its report."""
    module = sys.modules.get("rtamt.assertions")
    error = call.excinfo.value if call.excinfo is not None else None
    if module is not None and isinstance(error, module.UnsatisfiedError):
        lines = _plots(item, error)
        item.add_report_section(call.when, "requirements", "\n".join(lines))
        item.user_properties.extend(("rtamt.plot", line) for line in lines)
    return (yield)


def _plots(item: pytest.Item, error: UnsatisfiedError) -> list[str]:
    """Write a plot of each failed requirement; return the files, or why there are none."""
    from rtamt.errors import StlError
    from rtamt.plot.axes import matplotlib
    from rtamt.plot.saving import save

    try:
        figures = matplotlib("figure")
    except StlError as missing:
        return [str(missing)]
    folder = _folder(item.config)
    lines = []
    for name, part in error.failures.items():
        file = folder / (re.sub(r"[^\w.-]+", "_", "-".join(filter(None, (item.nodeid, name)))) + ".png")
        figure = part.plot(figure=figures.Figure())
        save(figure, str(file), 110)
        lines.append(f"plot: {file}")
    return lines


def _folder(config: pytest.Config) -> Path:
    given = config.getoption("--stl-plots")
    if given is not None:
        folder = Path(config.invocation_params.dir, given)
        folder.mkdir(parents=True, exist_ok=True)
        return folder
    cache = getattr(config, "cache", None)
    if cache is None:  # -p no:cacheprovider
        import tempfile

        return Path(tempfile.mkdtemp(prefix="rtamt-plots-"))
    return Path(cache.mkdir("rtamt-plots"))
