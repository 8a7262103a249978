"""Distances in the plane: of points to boxes, to discs and along a path."""

from __future__ import annotations

from itertools import pairwise

import numpy as np


def to_boxes(points: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Return the distances (n, m) of points (n, 2) to boxes (m, 4: left, bottom, right, top); 0 inside."""
    apart = np.maximum(boxes[None, :, :2] - points[:, None], points[:, None] - boxes[None, :, 2:])
    return np.hypot(*np.maximum(apart, 0.0).transpose(2, 0, 1))


def to_discs(points: np.ndarray, centres: np.ndarray, radius: float) -> np.ndarray:
    """Return the distances (n, m) of points (n, 2) to discs around centres (m, 2); 0 inside."""
    return np.maximum(np.hypot(*(points[:, None] - centres[None]).transpose(2, 0, 1)) - radius, 0.0)


def along(path: np.ndarray, spacing: float) -> np.ndarray:
    """Return points on a path (n, 2), its corners among them, at most ``spacing`` apart."""
    pieces = [path[:1]]
    for start, end in pairwise(path):
        count = max(1, int(np.ceil(np.hypot(*(end - start)) / spacing)))
        pieces.append(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start))
    return np.concatenate(pieces)


def length(path: np.ndarray) -> float:
    """Return the length of a path (n, 2)."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def wrapped(angle: float) -> float:
    """Return an angle in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def turned(vector: np.ndarray, angle: float) -> np.ndarray:
    """Return a vector turned to the left by an angle."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]])
