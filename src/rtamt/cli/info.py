"""``rtamt info``: the variables, horizon, pastified form, program and memory of a requirement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.command import (
    SPECIFICATION_DEFAULTS,
    CommandError,
    add_specification_options,
    add_time_option,
    is_trace,
    json_number,
    json_text,
    read_specification,
)
from rtamt.cli.compiled import after_passes, listing, load_compiled
from rtamt.cli.parser import OK
from rtamt.cli.reading_options import add_reading_options, recording
from rtamt.cli.terminal import printed, say
from rtamt.errors import UsageError, choices
from rtamt.language.parsing.lexer import quoted
from rtamt.language.printing.printer import excerpts
from rtamt.language.units.durations import format_duration
from rtamt.language.value_types import BOOLEAN, value_text
from rtamt.requirement_info import RequirementInfo, cut_operator, depth, info_of, loose_variable
from rtamt.signals.time_domains import DOMAINS

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence

    from rtamt.language.document import Declaration
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification

_DESCRIPTION = """\
Show the variables of a requirement, how far it looks ahead (its horizon), the equivalent requirement with past
operators only (its pastified form), and the program and the memory of its online monitor. For a recording (CSV,
Parquet, Excel, ..., or --sql), list its signals, and what was inferred. For a program written by
'rtamt compile', list its contents."""

_EPILOG = """\
Intervals (bounds of the robustness while samples are unknown) are tight if some trace attains them. Early verdicts
remain valid at the end of the trace unless a window loses instants there that were decided before they had samples.

Each line in the listing of the program is an instruction: %0, %1, ... are results, n is a width in
samples, and the lag is the number of samples after which a result is known. With --time dense, both
are in ticks of the resolution.

--json prints one object: {"name", "formula", "requirements", "latex", "semantics", "variables", "period",
"resolution", "horizon", "pastified", "program", "memory", "offline_only", "tight", "early_verdicts_hold"};
values that do not exist are null: dense time has no period, and its memory depends on the data. Durations are in
seconds, memory in bytes. The program depends on the semantics, the pastified form does not. For several
requirements, all values refer to their conjunction; each requirement has its own {"name", "description",
"severity", "formula", "horizon"}. Of a recording, it prints {"trace", "signals", "notes"}, each signal as {"name",
"column", "unit", "samples", "start", "end"} with times in seconds, or as dates if the recording has dates.

examples:
  rtamt info examples/request_grant/spec.stl
  rtamt info examples/request_grant/a_satisfied.csv
  rtamt info flight.ulg battery gps
  rtamt info "always[0:10]((req >= 3) -> eventually[0:500ms](gnt >= 3))" --period 100ms
  rtamt info "always(alarm -> eventually[0:70ms](stop))" --time dense
  rtamt info "x >= 3 until[0:5] y >= 3" --latex
  rtamt info "a + b >= -2 and a - b <= 3" --program"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser, nargs="?")
    add_time_option(parser)
    add_reading_options(parser)
    parser.add_argument(
        "signals",
        metavar="SIGNAL",
        nargs="*",
        help="for a recording: list only signals whose names contain one of these texts, such as battery",
    )
    parser.add_argument("--latex", action="store_true", help="print only the formula, as LaTeX")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--program", action="store_true", help="print only the program, and what the passes have made of it"
    )


def run(args: argparse.Namespace) -> int:
    """Print the properties."""
    if args.sql is not None or is_trace(args.spec):
        if args.set:
            raise CommandError("--set is for requirements, and this is a recording")
        if args.latex or args.program:
            raise UsageError("--latex and --program are for requirements, and this is a recording")
        _refuse_specification_options(args)
        if args.sql is not None and args.spec is not None:
            args.signals.insert(0, args.spec)
        trace = _select_signals(recording(args, args.sql or args.spec), args.signals)
        say(_recording_as_json(trace) if args.json else str(trace))
        return OK
    if args.spec is None:
        raise CommandError("name a requirement, a program or a recording; see 'rtamt info --help'")
    if args.program and (args.latex or args.json):
        raise UsageError("--program prints the program alone: leave out --latex and --json")
    if args.latex and args.json:
        raise UsageError("--latex prints the formula alone, and --json contains it: leave one out")
    if args.signals:
        raise CommandError(f"'{args.signals[0]}' chooses signals of a recording, and '{args.spec}' is none")
    _refuse_reading_options(args)
    program = load_compiled(args.spec)
    if program is not None:
        if args.set:
            raise CommandError(f"'{args.spec}' is a program: --set is for requirements")
        if args.latex or args.json:
            raise UsageError(f"'{args.spec}' is a program: --latex and --json are for requirements")
        say("\n".join(after_passes(program) if args.program else listing(program)))
        return OK
    spec = read_specification(args, args.time)
    if args.latex:
        say(spec.formula.latex(), exact=True)
        return OK
    facts = info_of(spec)
    if args.program:
        if facts.program is None:
            raise UsageError(
                facts.offline_only or "a specification with quantifiers has one program for each of them"
            )
        say("\n".join(after_passes(facts.program)))
        return OK
    say(_as_json(facts) if args.json else "\n".join(_lines(facts)))
    return OK


def _select_signals(trace: Trace, texts: Sequence[str]) -> Trace:
    """Return the signals whose names contain one of some texts, in any case; all where there is no text."""
    if not texts:
        return trace
    found = [name for name in trace.names if any(text.lower() in name.lower() for text in texts)]
    if not found:
        topics = dict.fromkeys(name.partition(".")[0] for name in trace.names)
        raise CommandError(
            f"no signal's name contains '{' or '.join(texts)}'{choices(texts[0], topics, 'topics')}"
        )
    return trace.select(found)


def _refuse_specification_options(args: argparse.Namespace) -> None:
    """Reject options for reading requirements if there is a recording."""
    for option, default in SPECIFICATION_DEFAULTS.items():
        if getattr(args, option) != default:
            raise CommandError(f"--{option} is for requirements, and this is a recording")


def _refuse_reading_options(args: argparse.Namespace) -> None:
    """Reject options for reading recordings if there is no recording."""
    for option in (
        "time_column",
        "time_unit",
        "name",
        "sheet",
        "query",
        "skip_nan",
        "hold_for",
        "resample",
        "how",
    ):
        if getattr(args, option) not in (None, []):
            raise CommandError(
                f"--{option.replace('_', '-')} is for recordings, and '{args.spec}' is a requirement or program"
            )


def _variables(spec: Specification) -> list[dict[str, Any]]:
    declared = {declaration.name: declaration for declaration in spec.document.declarations}
    rows = []
    for name in spec.input_names:
        declaration = declared.get(name) or declared.get(name.split(".")[0])
        rows.append(
            {
                "name": name,
                "type": declaration.type if declaration else None,
                "role": declaration.role if declaration else None,
                "unit": (declaration.unit or None) if declaration else None,
                "recorded": spec.recorded.get(name),
                "topic": spec.document.topics.get(name.split(".")[0]),
            }
        )
    return rows


def _parameters(spec: Specification) -> list[dict[str, Any]]:
    """Return the properties of each parameter."""
    return [
        {
            "name": declaration.name,
            "type": declaration.type,
            "value": _parameter_value(spec, declaration, spec.parameters[declaration.name]),
            "default": _parameter_value(spec, declaration, declaration.value),
            "unit": declaration.unit or None,
        }
        for declaration in spec.document.declarations
        if declaration.kind == "parameter"
    ]


def _parameter_value(
    spec: Specification, declaration: Declaration, value: float | None
) -> float | str | bool | None:
    """Return the value of a parameter as JSON has it: a number, the name of a member, or a Boolean."""
    type_ = spec.document.types.get(declaration.name)
    if value is None or type_ is None:
        return value
    return bool(value) if type_ is BOOLEAN else value_text(value, type_)


def _format_value(value: float | str | bool) -> str:
    """Return such a value as text."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else f"{value:g}"


def _requirements(facts: RequirementInfo) -> list[dict[str, Any]]:
    """Return the properties of each requirement; ``ahead``: its horizon in words."""
    rows = []
    for known in facts.spec.document.requirements:
        ahead = depth(facts.spec, known.formula)
        rows.append(
            {
                "name": known.name,
                "description": known.description,
                "severity": known.severity,
                "formula": printed(known.formula),
                "horizon": None if ahead is None else float(ahead),
                "ahead": "offline only" if ahead is None else f"horizon {format_duration(ahead)}",
                "explicit": known.explicit,
            }
        )
    return rows


def _about_step(spec: Specification) -> str:
    """Return the period or tick, and its origin."""
    if not spec.domain.sampled:
        return ", the tick in which time is counted"
    if spec.sampling is not None:
        return f" ({spec.sampling})"
    return " (the default; --period sets it)" if spec.domain.step is None else ""


def _kinds(spec: Specification) -> Iterator[str]:
    """Yield the lines about groups and enumerations, and that there are no variables."""
    if not spec.input_names:
        yield "variables  none"
    for i, group in enumerate(spec.document.groups.values()):
        fields = "; ".join(
            f"{each.type} {each.called or each.name}{f' [{each.unit}]' if each.unit else ''}"
            f"{f' = {quoted(each.name)}' if each.called else ''}"
            for each in group.fields
        )
        words = [group.role, group.name, "=", quoted(group.pattern), f"{{ {fields} }}" if fields else ""]
        yield f"{'' if i else 'groups':<11}{' '.join(word for word in words if word)}"
    for i, known in enumerate(spec.document.enumerations.values()):
        members = ", ".join(f"{name} = {code}" for name, code in known.members)
        yield f"{'' if i else 'types':<11}enum {known.name} {{ {members} }}"


def _lines(facts: RequirementInfo) -> Iterator[str]:
    spec = facts.spec
    if spec.name:
        yield f"name       {spec.name}"
    yield f"formula    {printed(spec.formula)}"
    required = {requirement.span for requirement in spec.document.requirements}
    named = [each for each in spec.document.assertions if each.name and each.span not in required]
    for assertion, text in zip(named, excerpts([each.formula for each in named]), strict=True):
        yield f"           {assertion.name} = {text}"
    for i, requirement in enumerate(_requirements(facts)):
        if requirement["explicit"] or len(required) > 1:
            about = [requirement["severity"], requirement["ahead"], requirement["description"]]
            label = "requires" if i == 0 else ""
            details = ", ".join(filter(None, about))
            yield f"{label:<11}{requirement['name']}: {requirement['formula']}  ({details})"
    if spec.semantics != "standard":
        yield f"semantics  {spec.semantics}"
    for i, variable in enumerate(_variables(spec)):
        topic = variable["topic"] and f"({variable['topic']})"
        unit = variable["unit"] and f"[{variable['unit']}]"
        recorded = variable["recorded"] and f"= {quoted(variable['recorded'])}"
        words = [variable["role"], variable["type"], variable["name"], unit, recorded, topic]
        yield f"{'' if i else 'variables':<11}{' '.join(word for word in words if word)}"
    yield from _kinds(spec)
    for i, parameter in enumerate(_parameters(spec)):
        unit = f" [{parameter['unit']}]" if parameter["unit"] else ""
        value, default = (_format_value(parameter[each]) for each in ("value", "default"))
        other = f"  (by default {default})" if value != default else ""
        yield f"{'' if i else 'parameters':<11}{parameter['name']} = {value}{unit}{other}"
    yield f"{spec.domain.setting:<11}{format_duration(facts.step)}{_about_step(spec)}"
    if facts.horizon is not None:
        ahead = format_duration(facts.horizon)
        yield f"horizon    {ahead}: the value at t is known at t + {ahead}"
        if not spec.groups:
            yield f"pastified  {'no: too large' if facts.pastified is None else printed(facts.pastified)}"
    name = loose_variable(facts)
    wide = f"sound, but may be wider than necessary: '{name}' raises and lowers the robustness"
    yield f"intervals  {'tight' if name is None else wide}"
    late = None if spec.domain.held_at_end else cut_operator(facts)
    changed = f"may change at the end of the trace, which cuts the windows of '{late}'"
    yield f"early      verdicts {'hold at the end of the trace' if late is None else changed}"
    if facts.program is None and facts.offline_only is None:
        yield "online     one program for each quantifier, which runs for each member that is present"
        return
    if facts.program is None:
        yield f"online     no: {facts.offline_only}"
        return
    if spec.domain.continuous:
        yield "memory     that of the changes inside the windows, whatever the length of the trace"
    elif facts.memory is None:
        yield "memory     only the compiled core reports it (leave out --backend python)"
    else:
        doubles = round(facts.memory / 8)
        yield f"memory     {facts.memory:,} bytes ({doubles:,} doubles), whatever the length of the trace"
    yield "program"
    for line in facts.program.disassemble().splitlines():
        yield f"  {line}"


def _recording_as_json(trace: Trace) -> str:
    from rtamt.cli.outcome import plain_time
    from rtamt.signals.listing import notes

    signals = []
    for name in trace.names:
        channel = trace.channel(name)
        times: Any = () if channel.times is None else channel.times
        signals.append(
            {
                "name": name,
                "column": channel.column,
                "unit": channel.unit or None,
                "samples": len(channel.values),
                "start": plain_time(times[0]) if len(times) else None,
                "end": plain_time(times[-1]) if len(times) else None,
            }
        )
    return json_text({"trace": trace.source, "signals": signals, "notes": notes(trace)})


def _as_json(facts: RequirementInfo) -> str:
    spec = facts.spec
    return json_text(
        {
            "name": spec.name,
            "formula": printed(spec.formula),
            "requirements": [
                {key: value for key, value in row.items() if key not in ("ahead", "explicit")}
                for row in _requirements(facts)
            ],
            "latex": spec.formula.latex(),
            "semantics": spec.semantics,
            "variables": _variables(spec),
            "parameters": [
                {key: json_number(each) if isinstance(each, float) else each for key, each in row.items()}
                for row in _parameters(spec)
            ],
            **{domain.setting: None for domain in DOMAINS.values()},
            spec.domain.setting: float(facts.step),
            "horizon": None if facts.horizon is None else float(facts.horizon),
            "pastified": None if facts.pastified is None else printed(facts.pastified),
            "program": None if facts.program is None else facts.program.disassemble().splitlines(),
            "memory": facts.memory,
            "offline_only": facts.offline_only,
            "tight": loose_variable(facts) is None,
            "early_verdicts_hold": spec.domain.held_at_end or cut_operator(facts) is None,
        }
    )
