"""The interface of a back end: what computes robustness in one time domain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula

#: The names of the back ends: the compiled core, and the definition in Python. The first is the default.
BACKENDS = ("cpp", "python")


class Backend(ABC):
    """Evaluates formulas over traces of one time domain."""

    @abstractmethod
    def evaluator(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[Any], Sequence[Any]]:
        """Return a function from a trace of ``inputs`` to the values of each formula.

        ``step``: that of the traces, in seconds. The function may be called again with other traces.
        """
