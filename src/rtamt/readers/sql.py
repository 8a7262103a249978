"""Databases, with SQLAlchemy: a query whose rows are samples."""

from __future__ import annotations

import re
from contextlib import ExitStack, contextmanager
from functools import partial
from os.path import abspath, isfile
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError
from rtamt.lazy.patterns import lazy_pattern
from rtamt.readers.source import CHUNK, Source, guarded, library, missing_file, opening, printable

if TYPE_CHECKING:
    from collections.abc import Iterator

_URL = lazy_pattern(r"[a-z][a-z0-9+]*://", re.IGNORECASE)
#: The driver that our extra brings; the one that SQLAlchemy tries first is another.
_POSTGRESQL = lazy_pattern(r"postgres(?:ql)?://")


def is_url(text: str) -> bool:
    """Return whether a text is the address of a database.

    >>> is_url("sqlite:///log.db"), is_url("C:/log.csv")
    (True, False)
    """
    return _URL.match(text) is not None


def open_sql(url: str, query: str | None) -> Source:
    """Run a query; the server sends its rows as they are read, wherever it can."""
    if query is None:
        raise UsageError(
            f"'{shown(url)}' is a database: say what to read with query=, or on the command line --query"
        )
    guard = partial(_reading, url)
    with guard():
        source = _open(url, query)
    return guarded(source, guard)


def _open(url: str, query: str) -> Source:
    from rtamt.readers.rows import table_of_rows

    sqlalchemy = library("sqlalchemy", "databases")
    with ExitStack() as stack:
        address = sqlalchemy.make_url(_POSTGRESQL.sub("postgresql+psycopg://", url, count=1))
        engine = sqlalchemy.create_engine(_read_only(address))
        stack.callback(engine.dispose)
        connection = stack.enter_context(engine.connect())
        streaming = connection.execution_options(stream_results=True, yield_per=CHUNK)
        # What looks like a parameter (:name) is part of the query, and has no value.
        result = streaming.execute(sqlalchemy.text(query.replace(":", r"\:")))
        if not result.returns_rows:
            raise TraceError(f"the query on '{shown(url)}' returns no rows; give a SELECT")
        columns = list(result.keys())
        return Source(shown(url), (table_of_rows(columns, result),), close=stack.pop_all().close)


def _read_only(address: Any) -> Any:
    """Return the read-only address of an SQLite database: SQLite would create a missing file."""
    path = address.database
    if address.get_backend_name() != "sqlite" or not path or path == ":memory:":
        return address
    if not path.startswith("file:"):
        if not isfile(path):
            raise missing_file(path)
        from urllib.parse import quote

        address = address.set(database=f"file:{quote(abspath(path))}")
    return address.update_query_dict({"mode": "ro", "uri": "true"})


@contextmanager
def _reading(url: str) -> Iterator[None]:
    """Convert database errors to error messages."""
    exceptions = library("sqlalchemy.exc", "databases")
    with opening(shown(url), "a database"):
        try:
            yield
        except exceptions.NoSuchModuleError as error:
            raise UsageError(f"there is no driver for '{shown(url)}': {_first_line(error)}") from None
        except ModuleNotFoundError as error:
            raise UsageError(
                f"'{shown(url)}' needs the Python module '{error.name}', which is not installed"
            ) from None
        except exceptions.SQLAlchemyError as error:
            raise TraceError(f"cannot read from '{shown(url)}': {_first_line(error)}") from None


def shown(url: str) -> str:
    """Return an address without its password; anything else as it is."""
    return re.sub(r"(://[^:/@]*):[^@]*@", r"\1:***@", url)


def _first_line(error: Exception) -> str:
    original = getattr(error, "orig", None) or error
    return printable(str(original).strip().split("\n")[0])
