"""Classes of nodes that were found equal, so that no two of them are compared again."""

from __future__ import annotations


class EqualNodes:
    """A class of nodes that were found equal; a union-find in which ``joined`` points to the parent class.

    It references no node, so that a formula does not keep alive the formulas to which it was compared.
    """

    __slots__ = ("joined",)

    def __init__(self) -> None:
        self.joined: EqualNodes | None = None


def representative(found: EqualNodes) -> EqualNodes:
    """Return the class that stands for all that were joined with one."""
    while (above := found.joined) is not None:
        if above.joined is not None:
            found.joined = above.joined  # path halving
        found = above
    return found
