"""A formula as a tree, each node with its value at an instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.extras import library
from rtamt.plot import style
from rtamt.plot.texts import literal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.scene import Node, Scene

#: Inches: of a box, between boxes, and of one character.
_HEIGHT, _BETWEEN, _BELOW, _LETTER = 0.62, 0.25, 0.5, 0.083
_MOST = 40  # boxes
_TEXT = 34
_TOP = 0.95  # inches


class _Box:
    """A node at its position in the tree: a shared sub-formula has several positions."""

    def __init__(self, node: Node, scene: Scene) -> None:
        self.node = node
        self.below: list[_Box] = []
        self.cut = node.hidden
        self.fails = node.fails_at(scene.at)
        number = style.number(node.line.at(scene.at))
        label = node.label if len(node.label) <= _TEXT else node.label[: _TEXT - 1] + "…"
        self.lines = (label, f"{style.SIGNS[not self.fails]} {number}")
        self.title = node.name or ""
        self.width = _LETTER * max(len(label), len(self.lines[1]), len(self.title), 7) + 0.2
        self.room = self.width  # of the whole tree below
        self.x = self.y = 0.0


def draw_tree(scene: Scene, figure: Any) -> None:
    """Draw the tree of a scene's formula into a figure, which is made as large as it needs to be."""
    root = _boxes(scene)
    depth, right = _place(root)
    total = _TOP + (depth + 1) * (_HEIGHT + _BELOW)
    width = max(right + 0.4, 6.0)
    figure.set_size_inches(width, total)
    figure.set_facecolor("white")
    axis = figure.add_axes((0, 0, 1, 1))
    axis.set_axis_off()
    shift = (width - right) / 2
    axis.set_xlim(-shift, width - shift)
    axis.set_ylim(total, 0)
    explanation = scene.explanation
    axis.text(
        -shift + 0.25,
        0.3,
        f"{style.SIGNS[explanation.satisfied]} {literal(scene.verdict)}",
        fontsize=12,
        fontweight="bold",
        va="center",
        color=style.HOLDS if explanation.satisfied else style.FAILS,
    )
    about = literal(explanation.summary[-2])
    axis.text(-shift + 0.25, 0.58, about, fontsize=8, va="center", color=style.QUIET)
    _draw(root, axis, None if scene.critical is None else scene.nodes[scene.critical[0]])


def _boxes(scene: Scene) -> _Box:
    """Return the tree; where it has too many boxes, its lower ones are left out."""
    root = _Box(scene.nodes[0], scene)
    queue, count = [root], 1
    for box in queue:
        if count + len(box.node.children) > _MOST:
            box.cut = bool(box.node.children) or box.cut
            continue
        box.below = [_Box(scene.nodes[child], scene) for child in box.node.children]
        count += len(box.below)
        queue += box.below
    return root


def _place(root: _Box) -> tuple[int, float]:
    """Give every box its place, its operands side by side below its middle; return depth and width."""
    order: list[tuple[_Box, int]] = []
    stack = [(root, 0)]
    while stack:
        box, depth = stack.pop()
        order.append((box, depth))
        stack.extend((child, depth + 1) for child in box.below)
    for box, _ in reversed(order):
        box.room = max(box.width, _row_width(box.below))
    for box, depth in order:  # box.x is where its room begins, until its operands have theirs
        box.y = _TOP + depth * (_HEIGHT + _BELOW)
        x = box.x + (box.room - _row_width(box.below)) / 2
        for child in box.below:
            child.x = x
            x += child.room + _BETWEEN
        box.x += (box.room - box.width) / 2
    return max(depth for _, depth in order), root.room


def _row_width(boxes: Sequence[_Box]) -> float:
    return sum(box.room + _BETWEEN for box in boxes) - _BETWEEN if boxes else 0.0


def _draw(root: _Box, axis: Any, critical: Node | None) -> None:
    patches = library("matplotlib.patches", "a plot", "plot")
    stack = [root]
    while stack:
        box = stack.pop()
        color = style.FAILS if box.fails else style.HOLDS
        middle, bottom = box.x + box.width / 2, box.y + _HEIGHT
        for child in box.below:
            axis.plot(
                [middle, child.x + child.width / 2],
                [bottom, child.y],
                color=style.QUIET,
                linewidth=1,
                zorder=1,
            )
        if box.cut:
            axis.text(middle, bottom + 0.16, "…", ha="center", va="center", color=style.QUIET, fontsize=12)
        frame = 3.0 if box.node is critical else 1.3
        axis.add_patch(
            patches.FancyBboxPatch(
                (box.x, box.y),
                box.width,
                _HEIGHT,
                boxstyle="round,pad=0,rounding_size=0.08",
                facecolor="white",
                edgecolor=color,
                linewidth=frame,
                zorder=2,
            )
        )
        axis.text(
            middle,
            box.y + 0.2,
            literal(box.lines[0]),
            ha="center",
            va="center",
            fontsize=9,
            family="monospace",
            color=style.INK,
            zorder=3,
        )
        axis.text(
            middle,
            box.y + 0.43,
            box.lines[1],
            ha="center",
            va="center",
            fontsize=9.5,
            fontweight="bold",
            color=color,
            zorder=3,
        )
        if box.title:
            title = literal(box.title)
            axis.text(box.x, box.y - 0.09, title, fontsize=8, va="center", color=style.QUIET, style="italic")
        stack.extend(box.below)
