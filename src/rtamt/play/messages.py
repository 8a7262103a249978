"""Requests of the page, validated: a malformed one is an error of one sentence."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError
from rtamt.language.units.durations import positive_period
from rtamt.lazy.dataclasses import dataclass
from rtamt.signals.arrays import is_number
from rtamt.signals.time_domains import DOMAINS

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

#: The largest request, specification, and number of signals and of points of a signal.
MOST_BYTES, MOST_TEXT, MOST_SIGNALS, MOST_POINTS = 4_000_000, 200_000, 64, 20_000
#: The largest number of samples of a drawn signal.
MOST_SAMPLES = 200_000
#: The widest drawing, in pixels.
_WIDEST = 8192

HOWS = ("", "hold", "linear")


class MessageError(StlError):
    """A request of the page is malformed."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A signal that the user draws: points in time, and whether values hold in between, or lie on lines."""

    points: tuple[tuple[float, float], ...]
    hold: bool


@dataclass(frozen=True, slots=True)
class Request:
    """A request: what to evaluate, and with which settings.

    ``signals``: the drawn ones, over ``duration`` seconds. ``recording``: a number; then nothing is drawn.
    ``resample``: how a recording is put on one time base, "" for not at all. ``focus``: the requirement that is
    explained and monitored, None for the one that the answer chooses. ``width``: of charts, in pixels. ``view``: begin
    and end of the visible time span, None for the whole trace. ``at``: the position of the cursor.
    """

    text: str
    time: str
    period: Fraction | None
    duration: float
    signals: Mapping[str, Drawn]
    recording: int | None
    resample: str
    focus: str | None
    width: int
    view: tuple[float, float] | None
    at: float | None

    @property
    def dense(self) -> bool:
        """Whether time is dense."""
        return DOMAINS[self.time].continuous

    @staticmethod
    def of(message: Mapping[str, Any]) -> Request:
        """Validate a message; raise :class:`MessageError`, or another error for an unusable period."""
        text = _text(message, "text", MOST_TEXT)
        time = _text(message, "time", 20)
        if time not in DOMAINS:
            raise MessageError(f"'time' is '{time}'; it must be one of {', '.join(DOMAINS)}")
        resample = _text(message, "resample", 20, "")
        if resample not in HOWS:
            raise MessageError(f"'resample' is '{resample}'; it must be hold, linear or empty")
        recording = message.get("recording")
        if recording is not None and (isinstance(recording, bool) or not isinstance(recording, int)):
            raise MessageError("'recording' must be a number that the server gave, or null")
        focus = message.get("focus")
        if focus is not None and not isinstance(focus, str):
            raise MessageError("'focus' must be the name of a requirement, or null")
        at = message.get("at")
        return Request(
            text=text,
            time=time,
            period=_period(_text(message, "period", 40, "")),
            duration=_number(message.get("duration", 0), "duration"),
            signals=_signals(message.get("signals", {})),
            recording=recording,
            resample=resample,
            focus=focus,
            width=int(min(max(_number(message.get("width", 800), "width"), 50), _WIDEST)),
            view=_view(message.get("view")),
            at=None if at is None else _number(at, "at"),
        )


def _text(message: Mapping[str, Any], name: str, most: int, default: str | None = None) -> str:
    value = message.get(name, default)
    if not isinstance(value, str):
        raise MessageError(f"'{name}' must be a text")
    if len(value) > most:
        raise MessageError(f"'{name}' has {len(value)} characters; at most {most} are allowed")
    return value


def _number(value: Any, name: str) -> float:
    if isinstance(value, bool) or not is_number(value) or not isfinite(value):
        raise MessageError(f"'{name}' must be a finite number")
    return float(value)


def _view(given: Any) -> tuple[float, float] | None:
    if given is None:
        return None
    if not isinstance(given, list) or len(given) != 2:
        raise MessageError("'view' must be two times, or null")
    begin, end = (_number(each, "view") for each in given)
    if begin >= end:
        raise MessageError("'view' must begin before it ends")
    return begin, end


def _period(text: str) -> Fraction | None:
    given = text.strip()
    if not given:
        return None
    return positive_period(float(given) if _is_decimal(given) else given)


def _is_decimal(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _signals(given: Any) -> dict[str, Drawn]:
    if not isinstance(given, dict):
        raise MessageError("'signals' must map names to drawn signals")
    if len(given) > MOST_SIGNALS:
        raise MessageError(f"there are {len(given)} signals; at most {MOST_SIGNALS} are allowed")
    return {name: _drawn_signal(name, each) for name, each in given.items()}


def _drawn_signal(name: str, given: Any) -> Drawn:
    if not isinstance(given, dict) or not isinstance(given.get("points"), list):
        raise MessageError(f"the signal '{name}' must have a list of points")
    points = given["points"]
    if not 1 <= len(points) <= MOST_POINTS:
        raise MessageError(f"the signal '{name}' has {len(points)} points; give 1 to {MOST_POINTS}")
    found: list[tuple[float, float]] = []
    for point in points:
        if not isinstance(point, list) or len(point) != 2:
            raise MessageError(f"a point of the signal '{name}' must be a pair of time and value")
        time, value = (_number(each, f"points of {name}") for each in point)
        if found and time <= found[-1][0]:
            raise MessageError(f"the points of the signal '{name}' must be in the order of time")
        found.append((time, value))
    return Drawn(tuple(found), given.get("hold") is not False)
