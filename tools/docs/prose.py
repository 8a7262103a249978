"""The conventions of a docstring, which the reference turns into what a page can show.

- A sentence such as "``period``: the sampling period." describes a parameter, up to the next parameter, to
  "Raises" or "Returns", or to the end of the paragraph.
- A block that starts with ``>>>`` is an example: it becomes highlighted code.
- A simple table becomes a table of Markdown.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

#: Where a sentence starts that is about a parameter, or about none again.
_START = re.compile(r"(?:^|(?<=[.)]\s))(?:``(\w+)``(?::\s| (?=as\s))|(?=(?:Raises|Returns)\s))")


def parts_of(text: str, parameters: Collection[str]) -> tuple[list[str], dict[str, str]]:
    """Return the parts of a docstring as Markdown, roles apart, and the descriptions of its parameters."""
    described: dict[str, str] = {}
    return list(_parts(text, parameters, described)), described


def _parts(text: str, parameters: Collection[str], described: dict[str, str]) -> Iterator[str]:
    for paragraph in re.split(r"\n\s*\n", text):
        if paragraph.startswith("    "):  # a literal block: code to Markdown, too
            yield paragraph
            continue
        if paragraph.startswith("==="):
            yield _table(paragraph.splitlines())
            continue
        prose, sign, example = re.match(r"(?ms)(.*?)(^>>>|\Z)(.*)", paragraph).groups()
        rest = _without_parameters(re.sub("::$", ":", prose.strip()), parameters, described)
        if rest:
            yield rest
        if sign:
            yield f"```pycon\n{sign}{example}\n```"


def _table(lines: list[str]) -> str:
    """Return a simple table of reStructuredText, with a heading and cells of one line, as one of Markdown."""
    rows = [re.split(r"\s{2,}", line.strip()) for line in lines if not line.startswith("===")]
    rows.insert(1, ["---"] * len(rows[0]))
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows)


def _without_parameters(prose: str, parameters: Collection[str], described: dict[str, str]) -> str:
    """Return a paragraph without the sentences about parameters, which are put into ``described``."""
    starts = [m for m in _START.finditer(prose) if not m[1] or m[1] in parameters]
    if not any(m[1] for m in starts):
        return prose
    ends = [*(m.start() for m in starts[1:]), len(prose)]
    rest = [prose[: starts[0].start()]]
    for match, end in zip(starts, ends, strict=True):
        if match[1]:
            sentence = prose[match.end() : end].strip()
            described[match[1]] = f"{described[match[1]]} {sentence}" if match[1] in described else sentence
        else:
            rest.append(prose[match.start() : end])
    return " ".join(part.strip() for part in rest if part.strip())
