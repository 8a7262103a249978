"""Find the specification files that others import: ``import "patterns.stl"``.

A file is looked up in the folder of the file that imports it, then in the package (``rtamt/library/``). A file is
read once, however often it is imported. Nothing else on the machine can be read: a path leads to a regular file
``*.stl`` in that folder or below it, also where symbolic links are followed.
"""

from __future__ import annotations

import os
import stat

from rtamt.errors import StlError, did_you_mean
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula, Span
    from rtamt.language.parsing.templates import Template

#: The files that are part of the package.
PACKAGED = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(__file__))), "library")
#: What the files that one specification imports may have together: files, and bytes.
MOST_FILES, MOST_BYTES = 200, 2**22
#: How deeply imports may be nested.
MOST_NESTED = 20

_IN_PACKAGE = "package:"


class ImportedFileError(StlError):
    """A file cannot be imported; the parser adds where it is."""


class Imported(NamedTuple):
    """A file that has been parsed.

    ``origins``: from each of its names to the file that defines it. ``placed`` returns its definitions and templates at
    the position of an import.
    """

    document: Document
    origins: Mapping[str, str]
    placed: Callable[[Span], tuple[Mapping[str, Formula], Mapping[str, Template]]]


@dataclass
class Library:
    """The files that a specification imports, directly or not.

    ``folder``: that of the specification, None for a text. ``found``: from the importing file and the path as written
    to the imported file and its text; what is in it is not read again, so that a specification can be parsed
    where its files are not.
    """

    folder: str | None = None
    found: dict[tuple[str, str], tuple[str, str]] = field(default_factory=dict)
    #: What has been parsed of them.
    documents: dict[str, Imported] = field(default_factory=dict)
    #: The files that are being parsed, from the outermost to the innermost.
    open: list[str] = field(default_factory=list)

    def read(self, path: str) -> tuple[str, str]:
        """Return the identity of the file that is imported as ``path``, and its text.

        Raises :class:`ImportedFileError`; its message never has contents of a file.
        """
        importing = self.open[-1] if self.open else ""
        known = self.found.get((importing, path))
        if known is None:
            known = self._read(importing, path)
            self.found[importing, path] = known
        file = known[0]
        if file in self.open:
            cycle = [*self.open[self.open.index(file) :], file]
            raise ImportedFileError(f"files cannot import each other, but {' -> '.join(map(called, cycle))}")
        if len(self.open) >= MOST_NESTED:
            raise ImportedFileError(
                f"imports are nested too deeply: at most {MOST_NESTED} files may import one another"
            )
        return known

    def _read(self, importing: str, path: str) -> tuple[str, str]:
        _check_path(path)
        folder = os.path.dirname(importing) if importing else self.folder
        if importing.startswith(_IN_PACKAGE):
            folder = None
        place = None if folder is None else _inside(folder, path)
        if place is None:
            packaged = _inside(PACKAGED, path)
            if packaged is None:
                raise ImportedFileError(_missing(folder, path))
            place, file = packaged, _IN_PACKAGE + path
        else:
            file = place
        return file, self._text(place, path)

    def _text(self, place: str, path: str) -> str:
        texts = dict(self.found.values())
        left = MOST_BYTES - sum(map(len, texts.values()))
        if len(texts) >= MOST_FILES:
            raise ImportedFileError(
                f"'{path}' is one file too many: a specification imports at most {MOST_FILES}"
            )
        try:
            with open(place, "rb") as file:
                content = file.read(left + 1)
        except OSError as error:
            raise ImportedFileError(f"cannot read '{path}': {error.strerror}") from None
        if len(content) > left:
            raise ImportedFileError(
                f"'{path}' is too long: imported files have at most {MOST_BYTES:,} bytes together"
            )
        try:
            return content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise ImportedFileError(f"'{path}' is not UTF-8 text (byte {error.start})") from None


class ImportsOthersError(Exception):
    """A file that was taken for one without imports has some."""


class NoLibrary(Library):
    """That of a file which imports no other: what is in it depends on its text alone."""

    def read(self, path: str) -> tuple[str, str]:  # noqa: ARG002 - it reads none
        """Raise :class:`ImportsOthersError`."""
        raise ImportsOthersError


def called(file: str) -> str:
    """Return the name of a file for messages: no folders."""
    return os.path.basename(file.removeprefix(_IN_PACKAGE))


def _check_path(path: str) -> None:
    """Raise unless a path is relative and leads downwards to a specification file, on every system."""
    from pathlib import PurePosixPath, PureWindowsPath

    parts = PurePosixPath(path).parts
    if PurePosixPath(path).is_absolute() or PureWindowsPath(path).anchor or "\\" in path or ".." in parts:
        raise ImportedFileError(
            "the path of an import is relative, with '/' and without '..': the file is in the folder of this one, "
            "or below it"
        )
    if not path.endswith(".stl") or not path.isprintable() or not parts:
        raise ImportedFileError("only specification files are imported: their names end in .stl")


def _inside(folder: str, path: str) -> str | None:
    """Return the regular file of this path in a folder, None if there is none; raise if a link leads out of it."""
    from pathlib import Path

    root = os.path.realpath(folder)
    place = os.path.realpath(os.path.join(root, path))
    try:
        status = os.stat(place)
    except (OSError, ValueError):
        return None
    if not Path(place).is_relative_to(root) or not place.endswith(".stl"):
        raise ImportedFileError(
            f"'{path}' is a link to another place; only files in the folder itself are imported"
        )
    if not stat.S_ISREG(status.st_mode):
        raise ImportedFileError(f"'{path}' is not a regular file")
    return place


def _missing(folder: str | None, path: str) -> str:
    from rtamt.files import nearest_file

    packaged = sorted(name for name in os.listdir(PACKAGED) if name.endswith(".stl"))
    if folder is None:
        return (
            f"there is no file '{path}' in the package ({', '.join(packaged)}), and a text has no folder of its own: "
            f"to import from a folder, load a file with rtamt.load, or name the folder: rtamt.parse(text, folder=...)"
        )
    near = nearest_file(os.path.join(folder, path))
    name = near.rpartition("/")[2].removesuffix("'?")
    hint = f"; did you mean '{name}'?" if name.endswith(".stl") else did_you_mean(path, packaged)
    return f"there is no file '{path}' in the folder of this file, nor in the package{hint}"


def moved(document: Document, span: Span) -> tuple[dict[str, Formula], dict[str, Template]]:
    """Return the definitions and templates of an imported file, at the position of its import.

    The positions in its own text would mean something else in the text that imports it. Formulas go on sharing nodes.
    """
    from rtamt.language.parsing.templates import all_placed

    scopes = {id(each.scope.definitions): each.scope.definitions for each in document.templates.values()}
    named = [document.definitions, *scopes.values()]
    made = iter(all_placed([formula for each in named for formula in each.values()], span))
    definitions, *others = [dict(zip(each, made, strict=False)) for each in named]
    of = dict(zip(scopes, others, strict=True))
    templates: dict[str, Template] = {}
    for name, each in document.templates.items():
        scope = replace(
            each.scope, definitions=of[id(each.scope.definitions)], templates=templates, pending={}
        )
        templates[name] = replace(each, scope=scope)
    return definitions, templates


def library_of(document: Document) -> Library:
    """Return a library of the files that a document imports, which are not read again."""
    return Library(None, dict(document.imported))
