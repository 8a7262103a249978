"""Convert every error of the library to an RTAMTException, with its message and caret."""

from __future__ import annotations

from functools import wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

from rtamt.errors import RTAMTException, SpecificationError, StlError, STLParseException

if TYPE_CHECKING:
    from collections.abc import Callable

P = ParamSpec("P")
R = TypeVar("R")


def raises_rtamt(method: Callable[P, R]) -> Callable[P, R]:
    """Make a method raise :class:`STLParseException` for invalid text, else :class:`RTAMTException`.

    The original error is the ``__cause__``.
    """

    @wraps(method)
    def translating(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return method(*args, **kwargs)
        except RTAMTException:
            raise
        except SpecificationError as error:
            raise STLParseException(str(error)) from error
        except StlError as error:
            raise RTAMTException(str(error)) from error

    return translating


#: Exceptions of RTAMT 0.3: errors of the classes are an RTAMTException, and those in the text an STLParseException.
STLException = STLOfflineException = STLSpecificationException = STLNotImplementedException = RTAMTException
LTLException = LTLOfflineException = LTLSpecificationException = LTLNotImplementedException = RTAMTException
LTLPastifyException = RTAMTException
LTLParseException = STLParseException
