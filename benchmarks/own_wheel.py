"""Our wheel in an environment of its own, as every peer has one: what a user installs, and not the development install.

Built again only where a file of the package has changed; the objects of the last build are kept in build/wheel.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
ENVIRONMENT = ROOT / "build" / "peers" / "this"
#: What a wheel is made of.
SOURCES = ("CMakeLists.txt", "LICENSE", "README.md", "core", "pyproject.toml", "src")


def python() -> str:
    """Return the interpreter of the environment, after the wheel of the present sources is installed in it."""
    installed, content, interpreter = ENVIRONMENT / "installed", _content(), ENVIRONMENT / "bin" / "python"
    if not installed.exists() or installed.read_text(encoding="utf-8") != content:
        print("building and installing our wheel ...", file=sys.stderr)
        folder = ROOT / "build" / "wheel"
        pip = ("-m", "pip", "--quiet", "--disable-pip-version-check")
        build = ("wheel", "--no-build-isolation", "--no-deps", f"--config-settings=build-dir={folder}")
        venv.create(ENVIRONMENT, with_pip=True, clear=True)
        subprocess.run([sys.executable, *pip, *build, "--wheel-dir", str(ENVIRONMENT), str(ROOT)], check=True)
        (wheel,) = ENVIRONMENT.glob("*.whl")
        subprocess.run([str(interpreter), *pip, "install", str(wheel)], check=True)
        installed.write_text(content, encoding="utf-8")
    return str(interpreter)


def _content() -> str:
    """Return a digest of the sources, their names included."""
    digest = hashlib.sha256(sys.version.encode())
    for name in SOURCES:
        found = [ROOT / name] if (ROOT / name).is_file() else sorted((ROOT / name).rglob("*"))
        for path in found:
            if path.is_file() and "__pycache__" not in path.parts:
                digest.update(f"\0{path.relative_to(ROOT)}\0".encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()
