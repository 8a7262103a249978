"""The command line ``rtamt``: every error is one sentence on stderr, never a traceback.

Each command is a module with the name of the command: ``check``, ``explain``, ``plot``, ``report``, ``export``,
``play``, ``monitor``, ``worker``, ``ros2``, ``falsify``, ``mutate``, ``mine``, ``classify``, ``info``, ``new``,
``describe``, ``lint``, ``format``, ``lsp``, ``analyze``, ``diff``, ``compile``, ``fmu``, ``convert``, ``packs``,
``operators``, ``completion``.
It has the functions ``configure`` and ``run``, and is imported when the command is used. The other modules are shared:

================  =============================================================
module            purpose
================  =============================================================
parser            ``Command``, the argument parser, exit codes
command           options of several commands, and how values are printed
arguments         specifications and recordings on the command line
reading_options   options for reading recordings
recordings        recordings that are all read before a command begins
parameters        the option ``--set``
language          the option ``--language``
conclusions       the answers of analyses: text, JSON and plots
outcome           the outcome of a requirement on a recording, as reports show it
runner            every requirement on every recording, on all cores
many              very many recordings: ``rtamt check --engine``
written_formats   the formats of ``--output``
early_outcomes    the same, reading a recording no further than the verdicts need
chunks            a recording that is read in chunks
bag               check a bag, and write a copy with the results
stdin_reader      JSON or CSV lines to samples
stream_json       JSON lines to samples
stream_csv        CSV lines to samples
stream_times      the timestamps of those lines
stream_members    the members of groups in JSON or CSV lines
inexact           missing samples and bounds in those lines
rounded           the note on integers in those lines that no double holds
json_lines        a line of JSON to numbers and timestamps
delayed_feeds     robustness one horizon later, as ``rtamt monitor`` prints it
early_feeds       verdicts and bounds before the horizon, as ``rtamt monitor`` prints them
held_feed         streams whose variables arrive at any time, sampled by ``sample ... hold``
robustness_lines  the lines of ``rtamt monitor`` for the robustness of each instant
live_view         the live view of ``rtamt monitor``
terminal          output, colours, tables, progress
compiled          ``rtamt info`` for compiled programs
report_formats    JUnit, SARIF and HTML reports
================  =============================================================
"""

from __future__ import annotations

import os
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING

import rtamt
from rtamt.cli.parser import ERROR, INTERRUPTED, OK, Command, Help, Parser, complain
from rtamt.cli.terminal import say
from rtamt.errors import StlError, UsageError, choices

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        name: Command(name, summary)
        for name, summary in (
            ("check", "evaluate recordings: robustness and verdict"),
            ("explain", "report which instants of which signals decide the verdict"),
            ("plot", "plot signals, robustness and the cause of the verdict"),
            ("report", "write an interactive page: signals, robustness, explanations"),
            ("export", "write signals and verdicts for Foxglove (MCAP) and Rerun"),
            ("play", "edit requirements and signals in a local web page, evaluated while typing"),
            ("monitor", "monitor a stream: samples on stdin, robustness on stdout"),
            ("worker", "monitor the samples of a Kafka topic, for many vehicles"),
            ("ros2", "monitor ROS 2 topics, publish robustness and verdicts"),
            ("falsify", "search for inputs that make a plant violate its requirement"),
            ("mutate", "change a requirement a little, and list the changes that no recording notices"),
            ("mine", "find parameters of a requirement from recordings"),
            ("classify", "learn a short list of rules that tells good recordings from bad ones"),
            ("info", "show the horizon, pastified form, program and memory of a requirement"),
            ("new", "write a specification file from a pattern"),
            ("describe", "print requirements as English sentences"),
            ("lint", "check specification files for errors and suspicious formulas"),
            ("format", "rewrite specification files in the common layout"),
            ("lsp", "serve editors: errors, completion, renaming, verdicts"),
            ("analyze", "find requirements that never hold, always hold, contradict or repeat others"),
            ("diff", "show a trace on which two versions of a specification disagree"),
            ("compile", "compile a requirement to a program that runs without Python"),
            ("fmu", "export a requirement as an FMU"),
            ("convert", "convert requirements of other tools, such as FRET, and the other way round"),
            ("packs", "list the packs of requirements, or print one"),
            ("operators", "list the operators of the language"),
            ("completion", "print the completion script for bash, zsh or fish"),
        )
    }
)

_EXAMPLES = """\
examples:
  rtamt check examples/request_grant/spec.stl examples/request_grant/*.csv
  rtamt info "always((req >= 3) -> eventually[0:5](gnt >= 3))"
  echo '{"time": 0, "x": 5}' | rtamt monitor "x >= 3"

exit codes:
  0 satisfied (or done), 1 violated, 2 error, with a one-sentence message on stderr
  (no message if the reader of the output exits early), 130 interrupted"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    # Threads that multiply matrices start with NumPy, and cost more than the rest of it; no command multiplies any.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if sys.stderr is None:  # closed: messages to it are lost
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - until the end of the process
    if sys.stdout is None:
        say("rtamt: stdout is closed, so that the output would be lost; use > /dev/null", file=sys.stderr)
        return ERROR
    try:
        return _exit_code(list(sys.argv[1:] if argv is None else argv))
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        _forget_output()  # the reader has closed the pipe on purpose
    except OSError as error:
        _forget_output()
        complain(f"cannot write the output: {error.strerror}")
    return ERROR


def _exit_code(argv: list[str]) -> int:
    try:
        code = _dispatch(argv)
    except StlError as error:
        complain(error)
        code = ERROR
    except (OSError, SystemExit):  # SystemExit: --help and --version have printed what they print
        sys.stdout.flush()
        raise
    except MemoryError:
        complain("not enough memory: are the bounds of a window as large as they should be?")
        code = ERROR
    except UnicodeEncodeError as error:
        complain(
            f"the output contains {error.object[error.start]!a}, which its encoding, {error.encoding}, lacks; "
            "set PYTHONIOENCODING=utf-8"
        )
        code = ERROR
    except Exception as error:  # noqa: BLE001 - a mistake of ours; the user gets a sentence all the same
        complain(f"internal error, please report it: {type(error).__name__}: {error}")
        code = ERROR
    sys.stdout.flush()
    return code


def _forget_output() -> None:
    """Discard the buffered output for stdout, so that Python reports no error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _dispatch(argv: list[str]) -> int:
    if not argv:
        say(overview().format_help().rstrip())
        return ERROR
    name, *rest = argv
    if name.startswith("-"):
        overview().read(argv)  # --help and --version do not return
    command = COMMANDS.get(name)
    if command is None:
        raise UsageError(
            f"there is no command '{name}'{choices(name, COMMANDS, 'commands')}; see 'rtamt --help'"
        )
    return command.run(parser_of(command).read(rest))


def parser_of(command: Command) -> Parser:
    """Return the argument parser of a command."""
    parser = Parser(
        prog=f"rtamt {command.name}",
        formatter_class=Help,
        allow_abbrev=False,
    )
    command.configure(parser)
    return parser


def overview() -> Parser:
    """Return the parser of the command line as a whole, whose help lists the commands."""
    width = max(map(len, COMMANDS))
    listing = "\n".join(f"  {c.name:<{width}}  {c.summary}" for c in COMMANDS.values())
    parser = Parser(
        prog="rtamt",
        usage="rtamt COMMAND ...",
        description=(
            "Runtime monitors for Signal Temporal Logic: compute the robustness of a requirement on recorded or "
            "live signals.\n\n"
            f"commands (details: 'rtamt COMMAND --help'):\n{listing}"
        ),
        epilog=_EXAMPLES,
        formatter_class=Help,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"rtamt {rtamt.__version__}")
    return parser


__all__ = ["COMMANDS", "OK", "main", "overview", "parser_of"]
