"""``parse``, ``load`` and ``robustness``."""

from __future__ import annotations

import os

from rtamt.errors import UsageError, choices, shown
from rtamt.language.operators import STL, Language
from rtamt.language.parsing.imports import PACKAGED, Library
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.units.durations import positive_period
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.semantics import semantics_of
from rtamt.settings import (
    check_backend,
    check_constants,
    check_language,
    roles_of,
)
from rtamt.signals.time_domains import DEFAULT, time_domain
from rtamt.specification import Specification

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from typing_extensions import Unpack

    from rtamt.language.document import Document
    from rtamt.language.units.durations import Duration
    from rtamt.settings import Semantics, Settings
    from rtamt.signals.time_domain_interface import TimeDomain


#: The folder of the packs.
_PACKS = os.path.join(PACKAGED, "packs")


def parse(
    text: str,
    *,
    period: Duration | None = None,
    unit: str = "s",
    backend: str = "cpp",
    constants: Mapping[str, float] | None = None,
    language: Language = STL,
    time: str | TimeDomain = DEFAULT,
    resolution: Duration | None = None,
    semantics: Semantics = "standard",
    roles: Mapping[str, str] | None = None,
    folder: str | os.PathLike[str] | None = None,
) -> Specification:
    """Parse a requirement: a formula, or the whole text of a specification file.

    ``period``: the sampling period, in seconds or as text such as ``"100ms"``; if it is given, every bound
    must be a multiple of it. ``unit``: the unit of bounds without a unit. ``backend``: ``"cpp"`` or ``"python"``.
    ``constants``: named numbers. ``time``: the default time domain of evaluations and monitors:
    ``"discrete"``, ``"dense"`` with ticks of ``resolution`` seconds, or a time domain with its settings,
    ``rtamt.Discrete(...)`` or ``rtamt.Dense(...)``. ``language``: the operators of the text, see
    ``rtamt.extend``. ``resolution``: the length of a tick of dense time. Raises :class:`SpecificationError`
    with the position in the text.

    ``semantics``: the semantics of predicates. By name: ``"standard"``, the robustness; ``"boolean"``,
    +inf or -inf by truth; and, relative to the interface (the paper's section 2.3),
    ``"output_robustness"``, ``"input_vacuity"``, ``"input_robustness"``, ``"output_vacuity"``. Or a
    function of a predicate and roles that returns the formula to replace it. ``roles``: from a
    variable to ``"input"`` or ``"output"``, overriding the declarations of the text; without a role, a
    variable is an output.

    ``folder``: the folder of the files that the text imports; without it, only files of the package
    can be imported, such as ``import "patterns.stl"``.

    >>> import rtamt
    >>> spec = rtamt.parse("always((req >= 3) -> eventually[0:5](gnt >= 3))", roles={"req": "input"})
    >>> spec.input_names
    ('req', 'gnt')
    >>> never_asked = {"req": [1, 2], "gnt": [0, 0]}
    >>> [spec.evaluate(never_asked, semantics=s).robustness for s in ("standard", "output_robustness")]
    [1.0, inf]
    """
    if text.__class__ is not str or text.endswith(".stl"):
        _refuse_path(text)
    check_language(language)
    check_backend(backend)
    check_constants({} if constants is None else constants)
    library = Library(None if folder is None else _folder(folder))
    document = parse_document(text, language=language, unit=unit, constants=constants, library=library)
    domain, exact = domain_of(document, time, period, resolution)
    rule = document.sampling
    spec = Specification(
        document,
        domain,
        exact,
        domain.resolution if resolution is None else positive_period(resolution, "resolution"),
        unit,
        backend,
        language,
        semantics_of(semantics),
        roles_of(document, {} if roles is None else roles),
        sampling=None if rule is None else replace(rule, period=exact or rule.period),
    )
    spec._check_bounds()
    return spec


def _refuse_path(text: object) -> None:
    """Raise :class:`UsageError` for the path of a file, which a formula of one name or a quotient may look like."""
    if isinstance(text, os.PathLike):
        raise UsageError(f"a formula is text, got the path {shown(os.fspath(text))}; rtamt.load reads a file")
    if isinstance(text, str) and not any(mark.isspace() or mark in '()<>=;"' for mark in text):
        raise UsageError(
            f"'{text}' is the name of a file; write rtamt.load({text!r}) (if a formula is meant, put it in parentheses)"
        )


def domain_of(
    document: Document, time: str | TimeDomain, period: Duration | None, resolution: Duration | None
) -> tuple[TimeDomain, Fraction | None]:
    """Return the time domain of a text, and its sampling period, which the text may give."""
    domain = time_domain(time, period, None, resolution)
    exact = domain.period if period is None else positive_period(period)
    rule = document.sampling
    if rule is not None and exact is None:
        exact = rule.period
        domain = type(domain).of(exact, domain.tolerance, domain.resolution)
    return domain, exact


def load(path: str | os.PathLike[str], **settings: Unpack[Settings]) -> Specification:
    """Load a specification file (``.stl``); settings and errors are those of :func:`parse`.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "limit.stl")
    ...     _ = path.write_text("specification limit; input float x; always(x <= 3)")
    ...     print(rtamt.load(path).name)
    limit
    """
    from rtamt.files import open_text

    given: object = os.fspath(path) if isinstance(path, os.PathLike) else path
    if not isinstance(given, str):
        raise UsageError(f"the path of a specification is {shown(path)}, expected text or a Path")
    try:
        with open_text(given) as file:
            text = file.read()
    except OSError as error:
        hint = (
            "; rtamt.parse takes the text of a formula"
            if "(" in given or ">" in given or "<" in given
            else ""
        )
        raise UsageError(f"cannot read the specification '{path}': {error.strerror}{hint}") from error
    except UnicodeDecodeError as error:
        raise UsageError(
            f"'{path}' is not UTF-8 text (byte {error.start}); is it a specification?"
        ) from error
    return parse(text, folder=os.path.dirname(given) or os.curdir, **settings)


def packs() -> tuple[str, ...]:
    """Return the names of the packs, see :func:`pack`."""
    return tuple(sorted(name[:-4] for name in os.listdir(_PACKS) if name.endswith(".stl")))


def pack(name: str, **settings: Unpack[Settings]) -> Specification:
    """Load a pack of requirements that is part of the package; settings and errors are those of :func:`parse`.

    Recordings need not have all signals of a pack: :meth:`Specification.unchecked` lists what cannot be checked.

    >>> import rtamt
    >>> spec = rtamt.pack("driving")
    >>> spec.name, "LIMIT-1" in spec.requirements
    ('driving', True)
    """
    if name not in packs():
        raise UsageError(f"there is no pack '{name}'{choices(name, packs(), 'packs')}")
    return load(os.path.join(_PACKS, f"{name}.stl"), **settings)


def _folder(folder: str | os.PathLike[str]) -> str:
    try:
        return os.fsdecode(folder)
    except TypeError:
        raise UsageError(f"folder is {shown(folder)}, expected text or a Path") from None


def robustness(text: str, data: Any, *, time_unit: str | None = None, **settings: Unpack[Settings]) -> float:
    """Return the robustness of a trace at its first instant; settings and errors are those of :func:`parse`.

    ``time_unit``: the unit of numeric times, by default seconds; see :meth:`Specification.evaluate`.

    >>> import rtamt
    >>> rtamt.robustness("eventually(x >= 3)", {"x": [1, 2, 5]})
    2.0
    """
    return parse(text, **settings).evaluate(data, time_unit=time_unit).robustness
