"""A requirement to a unit: a zip archive of its description, its program, and the runtime library."""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path
from platform import machine
from typing import TYPE_CHECKING

import rtamt
from rtamt import c_api
from rtamt.errors import UsageError
from rtamt.files import replacing
from rtamt.fmi.description import Unit, description, identifier
from rtamt.verdicts.modes import DELAYED

if TYPE_CHECKING:
    import os

    from rtamt.language.units.durations import Duration
    from rtamt.settings import Semantics
    from rtamt.specification import Specification

#: Each version with the names it has for the systems that a library may be for.
VERSIONS = (2, 3)
_SYSTEMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
_MACHINES = {"AMD64": "x86_64", "arm64": "aarch64"}
_OLD_NAMES = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}

#: Equal programs make equal archives: the time in them is that of the first entry a zip file can have.
_NO_TIME = (1980, 1, 1, 0, 0, 0)


def export(
    spec: Specification,
    path: str | os.PathLike[str],
    *,
    version: int = 2,
    time: str | None = None,
    period: Duration | None = None,
    resolution: Duration | None = None,
    semantics: Semantics | None = None,
    verdict: str = DELAYED,
    worst_case: bool = False,
) -> None:
    """Write a requirement's monitor as a Functional Mock-up Unit for co-simulation.

    ``version``: 2 for FMI 2.0, 3 for FMI 3.0. Other settings, and errors, as for
    ``Specification.compile``. The unit is for machines like this one; it needs neither Python nor a
    compiler. docs/how-to/fmi.md describes its variables and how steps become samples.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> from rtamt import fmi
    >>> spec = rtamt.parse("always[0:200ms](x >= 3)", period="100ms")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     fmi.export(spec, pathlib.Path(folder, "monitor.fmu"))
    ...     [file.name for file in pathlib.Path(folder).iterdir()]
    ['monitor.fmu']
    """
    if version not in VERSIONS:
        raise UsageError(
            f"there is no FMI version {version!r} to write, only {VERSIONS[0]} and {VERSIONS[1]}"
        )
    path = Path(path)
    program = spec.compile(
        time=time,
        period=period,
        resolution=resolution,
        semantics=semantics,
        verdict=verdict,
        worst_case=worst_case,
    )
    code = program.to_bytes()
    name = spec.name or path.stem
    # A program ends in its checksum; the runtime looks at the same four bytes.
    token = f"rtamt-{int.from_bytes(code[-4:], 'little'):08x}"
    units = {declared.name: declared.unit for declared in spec.document.declarations if declared.unit}
    unit = Unit(
        program, name, identifier(name), token, f"rtamt {rtamt.__version__}", units, spec.document.types
    )
    library = c_api.library()
    parts = {
        "modelDescription.xml": description(unit, version),
        f"binaries/{platform(version)}/{unit.identifier}{library.suffix}": library.read_bytes(),
        "resources/program.rtamt": code,
    }
    try:
        with replacing(path) as new, zipfile.ZipFile(new, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in parts.items():
                entry = zipfile.ZipInfo(name, _NO_TIME)
                entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
                archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    except OSError as error:
        raise UsageError(f"cannot write the unit '{path}': {error.strerror}") from error


def platform(version: int) -> str:
    """Return the name of this platform in a version of FMI.

    >>> platform(3).count("-")
    1
    """
    name = f"{_MACHINES.get(machine(), machine())}-{_SYSTEMS.get(sys.platform, sys.platform)}"
    return _OLD_NAMES.get(name, name) if version == 2 else name
