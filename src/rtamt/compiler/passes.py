"""The passes over a program: what each does, and how to leave it out. None changes a bit of a result.

======= ===================================================== ===============================
pass    effect                                                where
======= ===================================================== ===============================
hoist   windows and delays without constants are shared       ``hoist.py``
fuse    a chain of operators at one instant is one loop       ``core/program/fusion.hpp``
reuse   values share a register if never needed together      ``core/program/liveness.hpp``
======= ===================================================== ===============================

:data:`REWRITES` return another program. The others (:data:`LOADED`) are done by the core whenever it loads a
program: the header of the program contains those that it leaves out, one bit each.
"""

from __future__ import annotations

from types import MappingProxyType

from rtamt.compiler.hoist import hoist
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from rtamt.compiler.program import Program

#: Passes that rewrite a program, in order.
REWRITES: Mapping[str, Callable[[Program], Program]] = MappingProxyType({"hoist": hoist})

#: Passes of the core, in the order of their bits.
LOADED = ("fuse", "reuse")

#: All passes, in order.
PASSES = (*REWRITES, *LOADED)


def passed(program: Program, without: Collection[str] = ()) -> Program:
    """Return a program after all passes but those to be left out."""
    assert set(without) <= set(PASSES), without
    for name, rewrite in REWRITES.items():
        if name not in without:
            program = rewrite(program)
    left_out = frozenset(without) & set(LOADED)
    return replace(program, without=left_out) if left_out else program


def passes_of(program: Program) -> tuple[str, ...]:
    """Return the passes that a program goes through, in order; in continuous time the core makes none."""
    left_out = {*program.without, *(LOADED if program.domain.continuous else ())}
    return tuple(name for name in PASSES if name not in left_out)


def bits_of(without: Collection[str]) -> int:
    """Return the bits of the header for passes that the core leaves out."""
    return sum(1 << bit for bit, name in enumerate(LOADED) if name in without)


def without_of(bits: int) -> frozenset[str] | None:
    """Return the passes that bits of the header leave out, None if there are others."""
    if bits >> len(LOADED):
        return None
    return frozenset(name for bit, name in enumerate(LOADED) if bits >> bit & 1)
