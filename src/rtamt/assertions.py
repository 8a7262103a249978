"""Assert in a test that requirements are satisfied; the error message explains the violation."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.language.printing.printer import excerpt
from rtamt.signals.arrays import is_number
from rtamt.signals.listing import show_time
from rtamt.specification import Specification
from rtamt.specification_loader import load, parse
from rtamt.violations import first_violation

if TYPE_CHECKING:
    from rtamt.results import Result


class UnsatisfiedError(AssertionError):
    """Requirements are violated, or hold with less robustness than was requested.

    ``result``: the result of the evaluation. ``failures``: the results of the requirements that failed, by name.
    """

    def __init__(self, message: str, result: Result, failures: dict[str, Result]) -> None:
        super().__init__(message)
        self.result = result
        self.failures = failures


def assert_satisfied(
    spec: Specification | str | os.PathLike[str], data: Any, *, margin: float = 0.0, **options: Any
) -> Result:
    """Evaluate requirements on a recording, and raise an explained AssertionError if one is violated.

    ``spec``: a specification, its text, or the path of its file (a :class:`pathlib.Path`). ``data`` and ``options``:
    as for :meth:`Specification.evaluate`. ``margin``: the least robustness that each requirement must have, 0 or
    more; without it the verdict counts alone.

    Returns the result. Raises :class:`UnsatisfiedError`, an AssertionError, whose text states for each failed
    requirement the robustness, the first violation and its cause; and the errors of
    :meth:`Specification.evaluate`.

    >>> import rtamt
    >>> rtamt.assert_satisfied("always(gap >= 2)", {"gap": [5, 4, 3]}).robustness
    1.0
    >>> rtamt.assert_satisfied("always(gap >= 2)", {"gap": [5, 4, 1]})
    Traceback (most recent call last):
        ...
    rtamt.assertions.UnsatisfiedError: violated, robustness -1: always(gap >= 2)
    first violation at 2 s
    critical point at 2 s: 'gap >= 2' is -1; the robustness follows it up to 2
    sufficient cause, independent of all other samples:
      'gap >= 2' fails at 2 s (-1)
    """
    __tracebackhide__ = True  # pytest shows the line of the test
    if not is_number(margin) or not margin >= 0:
        raise UsageError(f"margin is {shown(margin)}, expected a number of at least 0")
    if isinstance(spec, os.PathLike):
        spec = load(spec)
    elif not isinstance(spec, Specification):
        spec = parse(spec)
    result = spec.evaluate(data, **options)
    failures = {
        name: part
        for name, part in result.requirements.items()
        if not (part.satisfied and (margin == 0 or _reaches(part, margin)))
    }
    if failures:
        raise UnsatisfiedError(_message(result, failures, margin), result, failures)
    return result


def _reaches(part: Result, margin: float) -> bool:
    """Return whether the robustness is at least the margin; raise EvaluationError if the samples leave it open."""
    bounds = part.interval
    return bounds.lower >= margin or (bounds.upper >= margin and part.robustness >= margin)


def facts(result: Result) -> dict[str, str]:
    """Return robustness, verdict and first violation of each requirement as text, for reports of tests.

    >>> import rtamt
    >>> facts(rtamt.parse("require low: always(x <= 3)").evaluate({"x": [1, 5]}))
    {'low.verdict': 'violated', 'low.robustness': '-2', 'low.first_violation': '1 s'}
    """
    found = {}
    for name, part in result.requirements.items():
        found[f"{name}.verdict"] = "satisfied" if part.satisfied else "violated"
        found[f"{name}.robustness"] = _robustness(part, 12)
        if not (part.satisfied or is_partly_known(part)):
            found[f"{name}.first_violation"] = show_time(first_violation(part), part.signal.times[0])
    return found


def _message(result: Result, failures: dict[str, Result], margin: float) -> str:
    several = len(result.requirements) > 1
    lines = [f"{len(failures)} of {len(result.requirements)} requirements failed"] if several else []
    for name, part in failures.items():
        text = _explain(part)
        if part.satisfied:
            text = f"the robustness is {_robustness(part, 6)}, less than the margin of {margin:.6g}\n{text}"
        lines.append(f"{name}: {text}" if several else text)
    return "\n".join(lines)


def is_partly_known(part: Result) -> bool:
    """Return whether samples are missing or uncertain: then there are neither explanations nor plots."""
    return bool(part.trace.bounds)


def _robustness(part: Result, digits: int) -> str:
    """Return the robustness, or its bounds where samples are missing or uncertain."""
    lower, upper = part.interval.lower, part.interval.upper
    return f"{lower:.{digits}g}" if lower == upper else f"{lower:.{digits}g} to {upper:.{digits}g}"


def _explain(part: Result) -> str:
    if not is_partly_known(part):
        return str(part.explain())
    verdict = "satisfied" if part.satisfied else "violated"
    return f"{verdict}, robustness {_robustness(part, 6)}: {excerpt(part.specification.formula)}"
