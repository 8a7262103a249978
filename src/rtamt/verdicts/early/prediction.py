"""Predictions of later samples: their radius from past errors, and their form for the monitor of bounds."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, inf, isnan
from typing import TYPE_CHECKING, Any, TypeAlias

from rtamt.compiler.graph import FOREVER, NEVER
from rtamt.errors import UsageError, did_you_mean, shown
from rtamt.lazy.modules import np
from rtamt.signals import arrays

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike

#: Bounds of all variables at samples (first, last), counted from the one after the newest.
Later: TypeAlias = "tuple[int, int, list[float], list[float]]"
#: Bounds of a variable from a tick on: its number, the tick, and the bounds.
Step: TypeAlias = "tuple[int, int, float, float]"


#: What may be given instead of two numbers, in discrete and in dense time.
_ARRAYS = "or two arrays of numbers of the same length"
_TIMED = "or (times, lower, upper), three arrays of the same length"


def calibrate(residuals: ArrayLike, delta: float) -> float:
    """Return a radius that the error of a new prediction exceeds with a probability of ``delta`` at most.

    ``residuals``: sizes of the errors of the predictor on n recordings that were not used to train it, one number
    each, such as the largest error over the horizon. The recordings and the new one must be exchangeable, for instance
    independent and identically distributed. Split conformal prediction (Lindemann et al., arXiv 2211.01539): the
    radius is the ⌈(n + 1)(1 - delta)⌉-th smallest residual, and infinite if n is too small for ``delta``.

    Raises :class:`UsageError` for residuals that are negative or no numbers, and a ``delta`` outside (0, 1).

    >>> import rtamt
    >>> rtamt.calibrate([0.3, 0.1, 0.2, 0.5, 0.4, 0.7, 0.6, 0.9, 0.8], delta=0.2)
    0.8
    >>> rtamt.calibrate([0.3, 0.1, 0.2], delta=0.2)
    inf
    """
    probability = arrays.number_of(delta)
    if probability is None or not 0 < probability < 1:
        raise UsageError(f"delta is {shown(delta)}; give a probability between 0 and 1, such as 0.05")
    try:
        errors = np.sort(np.asarray(residuals, float))
    except (TypeError, ValueError):
        raise UsageError(f"the residuals are {shown(residuals)}; give a list of numbers") from None
    if errors.ndim != 1:
        raise UsageError(f"the residuals have {errors.ndim} dimensions; give one number for each recording")
    if np.isnan(errors).any():
        raise UsageError(f"residual {int(np.isnan(errors).argmax())} is NaN; leave the recording out")
    if errors.size and errors[0] < 0:
        raise UsageError(
            f"the least residual is {errors[0]:g}; give the size of each error, such as abs(actual - predicted)"
        )
    # The decimal digits count: 10 * (1 - 0.9) is 1.
    rank = ceil((errors.size + 1) * (1 - Fraction(repr(probability))))
    return inf if rank > errors.size else float(errors[rank - 1])


def later_samples(
    prediction: Mapping[str, Any], names: Sequence[str], ranges: Sequence[tuple[float, float]]
) -> list[Later]:
    """Return the bounds of all variables at later samples, within their declared ranges.

    Raises :class:`UsageError` for wrong predictions.
    """
    _check_names(prediction, names)
    steps: dict[str, list[tuple[float, float]]] = {}
    always = dict(zip(names, ranges, strict=True))
    for name, given in prediction.items():
        each, constant = _bounds_of(name, given, _ARRAYS)
        each = [_clip(name, bounds, always[name]) for bounds in each]
        if constant:
            always[name] = each[0]
        else:
            steps[name] = each
    length = max(map(len, steps.values()), default=0)
    later: list[Later] = []
    for k in range(length):
        row = [steps[name][k] if k < len(steps.get(name, ())) else always[name] for name in names]
        later.append((k, k, [low for low, _ in row], [high for _, high in row]))
    last = [always[name] for name in names]
    return [*later, (length, FOREVER, [low for low, _ in last], [high for _, high in last])]


def later_steps(
    prediction: Mapping[str, Any],
    names: Sequence[str],
    ranges: Sequence[tuple[float, float]],
    ticks: Callable[[Any, str], Sequence[int]],
) -> list[Step]:
    """Return the bounds of variables in dense time, within their declared ranges; ``ticks``: from times to ticks.

    Raises :class:`UsageError` for wrong predictions.
    """
    _check_names(prediction, names)
    steps: list[Step] = []
    for number, name in enumerate(names):
        if name not in prediction:
            continue
        given, starts = prediction[name], [NEVER]
        if isinstance(given, tuple | list) and len(given) == 3:
            starts, given = list(ticks(given[0], name)), given[1:]
        each, _ = _bounds_of(name, given, _TIMED)
        if len(each) != len(starts):
            raise _wrong(name, prediction[name], _TIMED)
        for start, bounds in zip(starts, each, strict=True):
            steps.append((number, start, *_clip(name, bounds, ranges[number])))
    return steps


def _check_names(prediction: Mapping[str, Any], names: Sequence[str]) -> None:
    if not arrays.is_mapping(prediction):
        raise UsageError(
            f"prediction={shown(prediction)} is no mapping from variables; give for example {{'x': (0, 120)}}"
        )
    for name in prediction:
        if name not in names:
            raise UsageError(
                f"prediction has '{name}', which the formula does not read{did_you_mean(name, names)}"
            )


def _wrong(name: str, given: Any, arrays_of: str) -> UsageError:
    return UsageError(
        f"the prediction of '{name}' is {shown(given)}; give (lower, upper), two numbers {arrays_of}"
    )


def _bounds_of(name: str, given: Any, form: str) -> tuple[list[tuple[float, float]], bool]:
    """Return the bounds of a variable at later samples; one, and true, if they are the same at all.

    ``form``: what may be given instead of two numbers.
    """
    wrong = _wrong(name, given, form)
    try:
        low, high = (np.asarray(end, float) for end in given)
        low, high = np.broadcast_arrays(low, high)
    except (TypeError, ValueError):
        raise wrong from None
    if low.ndim > 1:
        raise wrong
    each = list(zip(np.atleast_1d(low).tolist(), np.atleast_1d(high).tolist(), strict=True))
    for k, (lower, upper) in enumerate(each):
        at = f" at step {k + 1}" if low.ndim else ""
        if isnan(lower) or isnan(upper):
            raise UsageError(f"the prediction of '{name}'{at} is NaN; leave out what is not predicted")
        if lower > upper:
            raise UsageError(
                f"the prediction of '{name}'{at} is ({lower:g}, {upper:g}), reversed; give (lower, upper)"
            )
    return each, low.ndim == 0


def _clip(name: str, bounds: tuple[float, float], limits: tuple[float, float]) -> tuple[float, float]:
    low, high = max(bounds[0], limits[0]), min(bounds[1], limits[1])
    if low > high:
        raise UsageError(
            f"the prediction of '{name}' is ({bounds[0]:g}, {bounds[1]:g}), outside its declared range "
            f"[{limits[0]:g}, {limits[1]:g}]: correct it, or declare a wider range"
        )
    return low, high
