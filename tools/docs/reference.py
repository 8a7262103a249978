"""Generate the reference pages from the operator table, docstrings, argparse and the messages in the source."""

from __future__ import annotations

import os
import re
from functools import partial
from importlib import import_module
from pathlib import Path
from textwrap import dedent
from typing import TYPE_CHECKING

import diagram
import messages

import rtamt
from rtamt.cli import COMMANDS, overview, parser_of
from rtamt.language import enumerations, tables
from rtamt.language import quantifiers as groups
from rtamt.language.operators import STL, Bounds, Fixity, Tense
from rtamt.language.parsing import parser, specfile, templates
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units import dimensions
from rtamt.lint.fix import with_fixes
from rtamt.lint.report import findings
from rtamt.lint.rules import ALL

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    from rtamt.language.operators import Operator
    from rtamt.lint.found import Rule

ROOT = Path(__file__).parents[2]

_GROUPS: tuple[tuple[str, Callable[[Operator], bool]], ...] = (
    ("Constants", lambda op: op.fixity is Fixity.ATOM),
    ("Numbers", lambda op: op.result.value == "number"),
    ("Predicates", lambda op: "number" in {operand.value for operand in op.operands}),
    ("Boolean operators", lambda op: op.tense is Tense.NONE),
    ("The past", lambda op: op.tense is Tense.PAST),
    ("The future", lambda op: op.tense is Tense.FUTURE),
)


def spelled() -> list[Operator]:
    """Return the operators with a spelling, in the order of the table."""
    return list(STL)


def diagrams() -> dict[str, str]:
    """Return the plot of each operator as SVG, by its path in the site."""
    return {f"reference/operators/{op.name}.svg": diagram.of(op.example) for op in spelled()}


# ---- the language -----------------------------------------------------------------------------------


def language() -> str:
    """Return the page of the operators: meaning, example and plot of each."""
    lines = [
        "# The language\n",
        "All operators of the language, generated from the operator table. Each plot shows the example on the "
        "same two signals with one sample per second: the signals above, the robustness below, green if positive "
        "and red if negative. [The grammar](grammar.md) defines the syntax, "
        "[the semantics](../explanation/semantics.md) the exact meaning.\n",
        "| operator | spelling | precedence | meaning |",
        "|---|---|---:|---|",
    ]
    lines += [
        f"| [{op.name}](#{op.name.replace('_', '-')}) | {_written(op)} | {op.power} | {_cell(op.doc)} |"
        for op in sorted(spelled(), key=lambda op: -op.power)
    ]
    lines.append(
        "\nA higher precedence binds tighter. Infix operators associate to the left, "
        f"{', '.join(f'`{op.spellings[0]}`' for op in STL if op.fixity is Fixity.RIGHT)} to the right.\n"
    )
    left = spelled()
    for title, belongs in _GROUPS:
        lines.append(f"## {title}\n")
        lines += [_operator(op) for op in left if belongs(op)]
        left = [op for op in left if not belongs(op)]
    assert not left
    lines.append(
        "## Quantifiers\n\nOver the members of a [group](specification-files.md#groups).\n\n"
        "| quantifier | example | meaning |\n|---|---|---|"
    )
    lines += [f"| `{op.name}` | `{op.example}` | {_cell(op.doc)} |" for op in QUANTIFIERS.values()]
    return "\n".join((*lines, ""))


def _operator(op: Operator) -> str:
    spec = rtamt.parse(op.example)
    facts = [f"spelling {_written(op)}"]
    facts += [f"interval {op.bounds.value}"] if op.bounds is not Bounds.NONE else []
    facts += ["discrete time only"] if op.discrete_only else []
    facts += [f"dual `{op.dual}`"] if op.dual else []
    facts += [f"past counterpart `{op.twin}`"] if op.twin else []
    expansion = op.expansion is not None and op.kernel is None
    facts += ["derived: the engine runs its expansion"] if expansion else []
    return (
        f"### {op.name} {{#{op.name.replace('_', '-')}}}\n\n{op.doc}\n\n"
        f"{' · '.join(facts)}\n\n```text\n{op.example}\n```\n\n"
        f"In LaTeX: `{spec.formula.latex()}`\n\n"
        f"![{op.name}: signals and robustness](operators/{op.name}.svg)\n"
    )


def _written(op: Operator) -> str:
    return ", ".join(f"`{_cell(spelling)}`" for spelling in op.spellings)


def _cell(text: str) -> str:
    return text.replace("|", r"\|")


# ---- the grammar ------------------------------------------------------------------------------------


def grammar() -> str:
    """Return the page of the grammar: the productions out of the parser's docstrings, the words out of the table."""
    kinds = {
        "prefix operator": (Fixity.PREFIX,),
        "infix operator": (Fixity.LEFT, Fixity.RIGHT),
        "function": (Fixity.FUNCTION,),
        "atom": (Fixity.ATOM,),
    }
    words = [
        f"{kind:<15} = "
        + " | ".join(f'"{s}"' for op in spelled() if op.fixity in fixities for s in op.spellings)
        for kind, fixities in kinds.items()
    ]
    listing = "\n".join(words)
    return (
        "# The grammar\n\nThe grammar in EBNF: `[ ]` is optional, `{ }` is repeated. An infix operator of lower "
        "[precedence](language.md) than its context ends an operand.\n\n"
        f"## A formula\n\n{_productions(parser)}\n\n```ebnf\n{listing}\n```\n\n"
        f"## A specification file\n\n{_productions(specfile)}\n\n"
        f"## Enumerations\n\n{_productions(enumerations)}\n\n"
        f"## Groups and quantifiers\n\n{_productions(groups)}\n\n"
        f"## Lookup tables\n\n{_productions(tables)}\n\n"
        f"## Templates\n\n{_productions(templates)}\n"
    )


def _productions(module: object) -> str:
    """Return the grammar in a module's docstring, and the prose after it."""
    doc = module.__doc__ or ""
    _, _, rest = doc.partition("::\n")
    block = re.match(r"(?:[ ]{4}.*\n|\n)+", rest)
    assert block, "the module's docstring has its grammar after '::'"
    prose = rest[block.end() :].strip().replace("``", "`")
    return f"```ebnf\n{dedent(block[0]).strip()}\n```\n\n{prose}"


# ---- the command line -------------------------------------------------------------------------------


def warnings() -> str:
    """Return the page of the warnings of ``rtamt lint``, from the table of its rules."""
    rows = [
        f"| [{rule.code}](warnings/{rule.code}.md) | {rule.severity} | {_cell(rule.about)} |" for rule in ALL
    ]
    return "\n".join(
        [
            "# Warnings\n",
            "Warnings report valid but suspicious specifications. `rtamt lint` and `rtamt check` print them on ",
            "stderr, with the line and a caret. They never prevent an ",
            "evaluation and do not change the exit code of `rtamt check`. That of `rtamt lint` is 2 for those of ",
            "severity error, and with `--strict` 1 for those of severity warning; `rtamt lint` alone prints notes. ",
            "`--json` prints them for programs. In Python: `rtamt.parse(...).warnings`. A guide is ",
            "[Check requirements before the first recording](../how-to/lint.md).\n",
            "`--ignore CODE` silences a warning, and so does a comment in the text: `// lint: ignore[CODE]` on the ",
            "same line, or alone on the line above.\n",
            "| code | severity | meaning |",
            "|---|---|---|",
            *rows,
            "",
        ]
    )


def warning(rule: Rule) -> str:
    """Return the page of one warning: what is wrong, a bad and a good example."""
    found = findings(parse_document(rule.bad))
    fixed = with_fixes(parse_document(rule.bad), parse_document, STL)
    shown = "\n".join(map(str, found))
    parts = [
        f"# {rule.code}: {rule.about}\n",
        f"{rule.why}\n",
        f"Severity: {rule.severity}.\n",
        f"Bad:\n\n```text\n{rule.bad}\n```\n",
        f"```text\n{shown}\n```\n",
        f"Good:\n\n```text\n{rule.good}\n```\n",
    ]
    if rule.code in fixed.codes:
        parts.append(f"`rtamt lint --fix` writes:\n\n```text\n{fixed.text}\n```\n")
    return "\n".join((*parts, "[All warnings](../warnings.md)\n"))


def command_line() -> str:
    """Return the page of the command line: the help of every command."""
    before = os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = "100"  # what argparse wraps to
    try:
        parts = [f"# The command line\n\n```text\n{overview().format_help()}```\n"]
        parts += [
            f"## rtamt {command.name}\n\n```text\n{parser_of(command).format_help()}```\n"
            for command in COMMANDS.values()
        ]
    finally:
        del os.environ["COLUMNS"]
        if before is not None:
            os.environ["COLUMNS"] = before
    return "\n".join(parts)


# ---- the API ----------------------------------------------------------------------------------------


#: The tasks, in the order in which a user meets them: what the page says of each, and what belongs to it. Of a
#: class, members that are named themselves are left out where the class is shown.
TASKS: dict[str, tuple[str, tuple[str, ...]]] = {
    "Parse and load": ("", ("parse", "load", "pack", "Specification")),
    "Evaluate": (
        "",
        (
            "Specification.evaluate", "Specification.evaluate_batch", "BatchResult", "robustness", "Result",
            "first_violation", "Signal", "evaluate_all",
            "evaluate_batch", "check_stream", "StreamResult", "Episode", "Discrete", "Dense",
        ),
    ),
    "Monitor": ("", ("Specification.monitor", "Monitor", "DenseMonitor")),
    "Monitor many keys": ("", (
            "Fleet", "FleetUpdate", "FleetPoints", "FleetVerdicts", "FleetBounds", "rtamt.fleet.reports.FleetChanges",
            "FleetCausation", "SuiteUpdate",
        )),
    "Verdicts": (
        "What the monitors of the [verdict modes](../how-to/early-verdicts.md) report.",
        (
            "rtamt.verdicts.early.discrete_eager.EagerMonitor", "Verdict",
            "rtamt.verdicts.early.dense_eager.DenseEagerMonitor", "VerdictRun",
            "rtamt.verdicts.early.interval.IntervalMonitor", "rtamt.signals.outcomes.Change", "Interval",
            "rtamt.verdicts.early.discrete_causation.DiscreteCausationMonitor",
            "rtamt.verdicts.early.dense_causation.DenseCausationMonitor",
            "Causation", "CausationRun", "Cause", "calibrate",
        ),
    ),
    "Very many recordings": (
        "", ("Suite", "VerdictTable", "rtamt.scale", "rtamt.scale.engines", "rtamt.scale.spark", "rtamt.scale.ray")
    ),
    "Live streams on engines": (
        "",
        (
            "rtamt.scale.shard.Shard", "rtamt.scale.messages.MessageReader", "rtamt.scale.kafka.Worker",
            "rtamt.scale.kafka_settings.Settings", "rtamt.scale.checkpoints.Checkpoints",
        ),
    ),
    "Metrics": ("", ("rtamt.metrics",)),
    "Robotics and telemetry tools": ("", ("rtamt.telemetry",)),
    "Explain": ("", ("Result.explain", "rtamt.explain.explanation.Explanation")),
    "Plot": ("", ("Result.plot", "Result.plot_tree")),
    "Assert in tests": ("", ("assert_satisfied", "rtamt.assertions.UnsatisfiedError")),
    "Notebooks": ("", ("rtamt.notebook", "rtamt.notebook.widget.ResultWidget")),
    "Read recordings": ("", ("read", "scan", "Trace", "Channel")),
    "Extend": ("", ("rtamt.extend", "rtamt.testing")),
    "Search": ("", ("rtamt.search",)),
    "Analyze requirements": ("", ("rtamt.analysis",)),
    "Other tools": ("Requirements of other tools, read and written.", ("rtamt.interchange",)),
    "Mutation": ("", ("rtamt.mutation",)),
    "Mining": ("", ("rtamt.mining",)),
    "Reinforcement learning": (
        "",
        (
            "rtamt.learning", "rtamt.learning.gymnasium_wrapper.RobustnessReward",
        "rtamt.learning.vector_wrapper.VectorRobustnessReward",
            "rtamt.learning.pettingzoo_wrapper.ParallelRobustnessReward",
        ),
    ),
    "ROS": ("", ("rtamt.ros",)),
    "C and C++": (
        "Compiled requirements run without Python: see [the program](program.md).", ("Specification.compile",)
    ),
    "FMI": ("", ("rtamt.fmi",)),
}  # fmt: skip


def api() -> str:
    """Return the page of the API: what `rtamt` exports and the modules that pages of docs/ import, by task."""
    placed = {name for _, names in TASKS.values() for name in names}
    missing = sorted({*rtamt.__all__, *public_modules()} - placed - {*_errors(), *_former(), "STL"})
    if missing:  # STL is part of rtamt.extend
        raise ValueError(f"give each a task in TASKS: {', '.join(missing)}")
    lines = ["# The API\n"]
    for title, (about, names) in TASKS.items():
        lines.append(f"## {title}\n\n{about}\n")
        lines += [f"::: {n}\n" if n.startswith("rtamt.") else _shown(n, placed) for n in names]
    for title, names in {"Errors": _errors(), "The classes of RTAMT": sorted({*_former().values()})}.items():
        lines.append(f"## {title}\n")
        lines += [f"::: rtamt.{name}\n    options:\n      inherited_members: false\n" for name in names]
    return "\n".join(lines)


def _shown(name: str, placed: Collection[str]) -> str:
    """Return what shows a function or class; of a class its members, except those that are placed themselves."""
    apart = sorted(other for other in placed if other.startswith(f"{name}."))
    hidden = "".join(f", '!^{other.partition('.')[2]}$'" for other in apart)
    return (
        f"::: rtamt.{name}\n    options:\n      inherited_members: true\n      filters: ['!^_[^_]'{hidden}]\n"
    )


def _errors() -> list[str]:
    return [name for name in rtamt.__all__ if getattr(rtamt, name).__module__ == "rtamt.errors"]


def _former() -> dict[str, str]:
    """Return the classes of RTAMT's own API; a second name of a class leads to its first."""
    found = {name: getattr(rtamt, name) for name in rtamt.__all__ if name not in {"STL"}}
    return {
        name: thing.__name__ for name, thing in found.items() if thing.__module__.startswith("rtamt.compat")
    }


def public_modules() -> list[str]:
    """Return the modules besides `rtamt` itself that pages import."""
    pages = "\n".join(p.read_text(encoding="utf-8") for p in sorted((ROOT / "docs").rglob("*.md")))
    named = set(re.findall(r"^(?:from|import) (rtamt\.\w+)", pages, re.MULTILINE))
    for names in re.findall(r"^from rtamt import ([\w, ]+)", pages, re.MULTILINE):
        named |= {f"rtamt.{name.strip()}" for name in names.split(",")}
    return sorted(name for name in named if _is_module(name))


def _is_module(name: str) -> bool:
    try:
        import_module(name)
    except ModuleNotFoundError:
        return False
    return True


# ---- the messages -----------------------------------------------------------------------------------


def _messages() -> Iterator[str]:
    yield "# Messages\n"
    yield (
        "All error messages, extracted from the source: search this page for the words of a message. "
        "Variable parts are in ⟨brackets⟩. Errors in a text also show the line and a caret under the "
        "position. On the command line every message is one line on stderr, with exit code 2.\n"
    )
    for kind, found in messages.by_kind(ROOT / "src/rtamt").items():
        error = getattr(rtamt, kind, None) or getattr(dimensions, kind, None)
        doc = (error.__doc__ or "").strip().partition("\n")[0] if error else ""
        yield f"## {kind}\n\n{doc}\n"
        yield "\n".join(f"- {text}" for text in found) + "\n"


#: Page and what makes it.
PAGES: dict[str, Callable[[], str]] = {
    "reference/language.md": language,
    "reference/grammar.md": grammar,
    "reference/command-line.md": command_line,
    "reference/api.md": api,
    "reference/warnings.md": warnings,
    **{f"reference/warnings/{rule.code}.md": partial(warning, rule) for rule in ALL},
    "reference/messages.md": lambda: "\n".join(_messages()),
}
