"""An mkdocs hook: what `make docs` adds to the pages under docs/.

The order of the pages, those that are made while the site is built (nothing generated is committed), and
links that leave docs/: to another page of the site where the file is one, else to a copy of the file.
"""

from __future__ import annotations

import posixpath
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).parent))  # mkdocs loads this file by its path

import reference

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]

#: Files of the repository that are pages of the site as they are.
INCLUDED = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "conformance/RESULTS.md": "explanation/conformance.md",
    "conformance/README.md": "reference/conformance-corpus.md",
}

#: The sections, in the order in which they are read. Each holds the pages of its folder, the first ones named.
SECTIONS = {
    "How-to": ("how-to", ["logs"]),
    "Reference": (
        "reference",
        [
            "language",
            "grammar",
            "specification-files",
            "patterns",
            "command-line",
            "api",
            "messages",
            "warnings",
        ],
    ),
    "Warnings": ("reference/warnings", []),
    "Explanation": (
        "explanation",
        [
            "semantics",
            "horizon",
            "interface-aware",
            "engine",
            "architecture",
            "rtamt",
            "choosing",
            "expressiveness",
        ],
    ),
}

_LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Set the order of the pages."""
    made = [*reference.PAGES, *INCLUDED.values()]
    nav: list[object] = [{"Home": "index.md"}, {"Tutorial": "tutorial.md"}]
    for title, (folder, first) in SECTIONS.items():
        found = {p.stem for p in (ROOT / "docs" / folder).glob("*.md")}
        found |= {Path(page).stem for page in made if posixpath.dirname(page) == folder}
        ordered = [name for name in first if name in found] + sorted(found - set(first))
        nav.append({title: [f"{folder}/{name}.md" for name in ordered]})
    nav.append({"Project": ["changelog.md", "contributing.md", "security.md"]})
    config.nav = nav
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what is not under docs/."""
    for source, page in INCLUDED.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=text))
    for page, make in reference.PAGES.items():
        files.append(File.generated(config, page, content=make()))
    for name, content in reference.diagrams().items():
        files.append(File.generated(config, name, content=content))
    for target in sorted(_copied(files)):
        files.append(File.generated(config, f"files/{target}", abs_src_path=str(ROOT / target)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Turn links that leave docs/ into links inside the site."""
    here = page.file.src_uri

    def mended(match: re.Match[str]) -> str:
        target = _target(here, match[2])
        if target is None:
            return match[0]
        if target in INCLUDED:
            inside = INCLUDED[target]
        elif target.startswith("docs/"):
            inside = target.removeprefix("docs/")
        else:
            inside = f"files/{target}"
        return match[1] + posixpath.relpath(inside, posixpath.dirname(here) or ".") + match[3]

    return _LINK.sub(mended, markdown)


def _target(page: str, link: str) -> str | None:
    """Return the file of the repository that a link of a page names; None where it is an address."""
    if ":" in link:
        return None
    origin = next((source for source, name in INCLUDED.items() if name == page), f"docs/{page}")
    if origin.startswith("docs/") and page in reference.PAGES:
        return None
    return posixpath.normpath(posixpath.join(posixpath.dirname(origin), link))


def _copied(files: Files) -> set[str]:
    """Return the files that pages link to and that are no pages."""
    found = set()
    for file in files.documentation_pages():
        for match in _LINK.finditer(file.content_string):
            target = _target(file.src_uri, match[2])
            if (
                target
                and target not in INCLUDED
                and not target.startswith("docs/")
                and (ROOT / target).is_file()
            ):
                found.add(target)
    return found
