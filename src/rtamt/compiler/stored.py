"""Plans without formulas: programs and scans, which bytes can carry."""

from __future__ import annotations

from functools import cached_property, partial
from types import MappingProxyType

from rtamt.compiler.metadata import Metadata, damaged
from rtamt.compiler.places import Deferred
from rtamt.compiler.plan import DEFINED, Plan, Scan, Stage
from rtamt.compiler.slices import sliced
from rtamt.errors import UsageError
from rtamt.language.formula import Apply
from rtamt.language.records import Blocks, Compiled
from rtamt.language.undefined_value import meaning_of
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.desugar import as_written

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula

#: Instructions that have a value wherever their operands have one: no message names them.
_SAFE = frozenset(
    """input const neg abs min max shift holds_gt holds_ge holds_eq slide_max slide_min run_max run_min
    since until at_least rank_max rank_min""".split()
)

#: No stored number of steps is larger, so that sums of two fit 64 bits.
LATEST = 2**61

_SCANS = ("run_max", "run_min", "until")


def is_built_in(node: Formula) -> bool:
    """Return whether the core has a built-in kernel for an operator, so that bytes can carry it."""
    return not isinstance(node, Apply) or not isinstance(node.op.kernel, Blocks | Compiled | None)


class _Meanings:
    """The texts of instructions that may have no value: written when one is read, or with the bytes of a program."""

    def __init__(self, plan: Plan, asked: Sequence[Formula]) -> None:
        self._plan = plan
        self._asked = asked

    @cached_property
    def _texts(self) -> dict[Formula, Formula]:
        return as_written(self._asked)

    def of(self, program: Program) -> Iterator[tuple[int, str]]:
        """Yield each such instruction of a program of the plan, and the text of what it computes."""
        original = self._plan.originals()
        for place, origin in enumerate(program.origins):
            if isinstance(origin, Apply) and program.instructions[place].opcode not in _SAFE:
                formula = program.origin_of(place)
                assert formula is not None
                formula = original(formula)
                yield place, meaning_of(self._texts.get(formula, formula))


@dataclass(frozen=True, slots=True)
class StoredPlan:
    """A plan whose programs have texts in place of formulas (``Metadata.meanings``).

    ``settled``: ticks after the last sample until past windows have settled, which scans of dense time read.
    """

    plan: Plan
    settled: int = 0

    @staticmethod
    def of(plan: Plan, asked: Sequence[Formula], settled: int = 0) -> StoredPlan:
        """Return a plan without its formulas; ``asked``: these as written.

        Raises :class:`UsageError` for a custom operator, whose code bytes cannot carry.
        """
        meanings = _Meanings(plan, asked)

        def without_formulas(program: Program) -> Program:
            for site in program.calls:
                raise UsageError(
                    f"the operator '{site.op.name}' has code of its own, which bytes cannot carry"
                )
            names = tuple(map(str, range(len(program.outputs))))
            metadata = Metadata(outputs=names, meanings=Deferred(partial(meanings.of, program)))
            nothing: Mapping[Formula, int] = MappingProxyType({})
            return replace(
                program, metadata=metadata, value_of=nothing, origins=(), parameters=MappingProxyType({})
            )

        for stage in plan.stages:
            for scan in stage.scans:
                if scan.kind == DEFINED:
                    assert scan.meaning is not None
                    raise UsageError(
                        f"the operator '{scan.meaning.op.name}' has code of its own, which bytes cannot carry"
                    )
        stages = [replace(stage, program=without_formulas(stage.program)) for stage in plan.stages]
        return StoredPlan(Plan(tuple(stages), without_formulas(plan.program)), settled)

    @property
    def outputs(self) -> int:
        """The number of outputs."""
        return len(self.plan.program.outputs)

    def part(self, outputs: Sequence[int], kept_inputs: Collection[str] = ()) -> StoredPlan:
        """Return the plan of some outputs alone; arguments as for :func:`sliced`."""
        program = sliced(self.plan.program, outputs, kept_inputs)
        needed = set(program.inputs)
        stages: list[Stage] = []
        for stage in reversed(self.plan.stages):
            scans = [scan for scan in stage.scans if scan.name in needed]
            if not scans:
                continue
            places = list(dict.fromkeys(output for scan in scans for output in scan.outputs))
            part = sliced(stage.program, places, kept_inputs)
            moved = [replace(scan, outputs=tuple(map(places.index, scan.outputs))) for scan in scans]
            stages.insert(0, Stage(part, tuple(moved)))
            needed.update(part.inputs)
        return StoredPlan(Plan(tuple(stages), program), self.settled)

    def reads(self) -> list[frozenset[str]]:
        """Return the variables that each output depends on."""
        of_scan: dict[str, frozenset[str]] = {}
        for stage in self.plan.stages:
            read = _read_by_outputs(stage.program, of_scan)
            for scan in stage.scans:
                of_scan[scan.name] = frozenset[str]().union(*(read[output] for output in scan.outputs))
        return _read_by_outputs(self.plan.program, of_scan)

    def programs(self) -> Iterator[Program]:
        """Yield all programs, in the order in which they run."""
        for stage in self.plan.stages:
            yield stage.program
        yield self.plan.program

    def listing(self) -> dict[str, Any]:
        """Return what is stored in addition to the bytes of the programs."""
        scans = [[[s.name, s.kind, list(s.outputs)] for s in stage.scans] for stage in self.plan.stages]
        return {"scans": scans, "settled": self.settled}

    @staticmethod
    def read(listing: Any, programs: Iterator[Program], variables: Collection[str]) -> StoredPlan:
        """Return the plan of a :meth:`listing` and its programs; raise :class:`UsageError` unless they fit."""
        known = set(variables)
        stages = []
        for given in listing["scans"]:
            program = _fitting(programs, known)
            scans = []
            for name, kind, outputs in given:
                width = 2 if kind == "until" else 1
                fits = kind in _SCANS and len(outputs) == width and name not in known
                if not fits or not all(0 <= output < len(program.outputs) for output in outputs):
                    raise damaged(f"its scan '{name}' does not fit its program")
                known.add(name)
                scans.append(Scan(name, kind, tuple(outputs), None))
            stages.append(Stage(program, tuple(scans)))
        settled = listing["settled"]
        if type(settled) is not int or not 0 <= settled < LATEST:
            raise damaged(f"it settles after {settled!r} ticks")
        return StoredPlan(Plan(tuple(stages), _fitting(programs, known)), settled)


def _read_by_outputs(program: Program, of_scan: Mapping[str, frozenset[str]]) -> list[frozenset[str]]:
    """Return the variables that each output of a program depends on; ``of_scan``: those of each scan."""
    nothing = frozenset[str]()
    read: list[frozenset[str]] = []
    for instruction in program.instructions:
        found = nothing
        if instruction.opcode == "input":
            name = program.inputs[instruction.n]
            found = of_scan.get(name, frozenset((name,)))
        for operand in (instruction.a, instruction.b):
            if operand is not None and not read[operand] <= found:
                found = found | read[operand]
        read.append(found)
    return [read[output] for output in program.outputs]


def _fitting(programs: Iterator[Program], known: Collection[str]) -> Program:
    program = next(programs, None)
    if program is None:
        raise damaged("a program is missing")
    for name in program.inputs:
        if name not in known:
            raise damaged(f"a program reads '{name}', which nothing provides")
    return program
