"""The Pareto front of two parameters: values of which neither can be harder without a violation.

The values that satisfy a template are a set that contains, with each pair, every easier one. Its front is found as in
J. Legriel, C. Le Guernic, S. Cotton, O. Maler, "Approximating the Pareto front of multi-criteria optimization problems"
(TACAS 2010), and E. Asarin, A. Donzé, O. Maler, D. Nickovic, "Parametric identification of temporal properties" (RV
2011), on a grid: each point that is found leaves two boxes in which there may be others, and the largest box is next.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import TYPE_CHECKING, TypeAlias

from rtamt.mining.grid import hardest
from rtamt.mining.region import Spent

if TYPE_CHECKING:
    from collections.abc import Callable

    #: Whether a pair holds, by the numbers of its values.
    Holds: TypeAlias = Callable[[int, int], bool]

#: From x, to x, from y, to y, all included.
Box: TypeAlias = tuple[int, int, int, int]


def front(holds: Holds, last: tuple[int, int], points: int) -> tuple[list[tuple[int, int]], float]:
    """Return points of the front, and the share of the area between its ends in which there may be others.

    ``holds``: of numbers of values, of which (0, 0) holds; ``last``: the greatest numbers; ``points``: how many points
    are enough. If the share is 0, the front is complete. Where the budget is spent, it is not.

    >>> front(lambda x, y: x * y <= 12, (8, 12), 50)
    ([(1, 12), (2, 6), (3, 4), (4, 3), (6, 2), (8, 1)], 0.0)
    """
    found: list[tuple[int, int]] = []
    boxes: list[tuple[int, Box]] = []
    whole = 1.0
    try:
        x = hardest(lambda k: holds(k, 0), last[0])
        right = x, hardest(lambda k: holds(x, k), last[1])
        found.append(right)
        y = right[1] + hardest(lambda k: holds(0, right[1] + k), last[1] - right[1])
        left = hardest(lambda k: holds(k, y), last[0]), y
        if left == right:
            return found, 0.0
        found.append(left)
        _add(boxes, (left[0] + 1, right[0] - 1, right[1] + 1, left[1] - 1))
        whole = float(sum(-area for area, _ in boxes)) or 1.0
        while boxes and len(found) < points:
            _, box = boxes[0]
            point = _point(holds, box)
            heappop(boxes)
            if point is not None:
                found.append(point)
                _add(boxes, (box[0], point[0] - 1, point[1] + 1, box[3]))
                _add(boxes, (point[0] + 1, box[1], box[2], point[1] - 1))
    except Spent:
        if len(found) < 2:
            return found, 1.0
    return sorted(found), sum(-area for area, _ in boxes) / whole


def _add(boxes: list[tuple[int, Box]], box: Box) -> None:
    if box[0] <= box[1] and box[2] <= box[3]:
        heappush(boxes, (-(box[1] - box[0] + 1) * (box[3] - box[2] + 1), box))


def _point(holds: Holds, box: Box) -> tuple[int, int] | None:
    """Return a point of the front in a box, next to its diagonal; None if nothing in the box holds."""
    x, most_x, y, most_y = box
    if not holds(x, y):
        return None
    wide, high = most_x - x, most_y - y
    steps = max(wide, high)
    k = hardest(lambda k: holds(x + wide * k // steps, y + high * k // steps), steps)
    at_x, at_y = (x + wide * k // steps, y + high * k // steps) if steps else (x, y)
    right = at_x + hardest(lambda k: holds(at_x + k, at_y), most_x - at_x)
    return right, at_y + hardest(lambda k: holds(right, at_y + k), most_y - at_y)
