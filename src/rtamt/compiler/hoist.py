"""Constants out of windows and delays, where windows over the same operand can then be shared.

``min(a - c)`` over a window is ``min(a) - c``, and ``min(c - a)`` is ``c - max(a)``: so 1 000 formulas
``always[0:20](a >= c)`` need one window. The bits are the same:

- Rounding is monotone, so the operation maps the least operand to the least result.
- A difference of equal numbers is +0 for ``c != 0``. For ``c == 0`` an operation maps zeros either all to +0
  or as identity and negation do, and windows choose among equal operands by their order alone.
- Constants are finite, so an empty window or a fill stays infinite, and no result becomes undefined. Parameters
  stay where they are: their values may become infinite.

In dense time nothing is moved: changes of a signal that the operation removes would reach the windows.
"""

from __future__ import annotations

from collections import Counter
from math import isfinite, isinf

from rtamt.compiler.places import Deferred, Origins
from rtamt.compiler.program import CODES, records_of
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.compiler.program import Instruction, Program

#: Windows and delays, and what they are over the negated operand.
_OPPOSITE = {
    "slide_min": "slide_max",
    "slide_max": "slide_min",
    "run_min": "run_max",
    "run_max": "run_min",
    "shift": "shift",
}
_MOVED = frozenset(CODES[opcode] for opcode in _OPPOSITE)
_CONST, _NEG, _ADD, _SUB = (CODES[opcode] for opcode in ("const", "neg", "add", "sub"))
_LINEAR = _NEG, _ADD, _SUB


class _Move(NamedTuple):
    """The replacement of an instruction: the operations, in order, of a window of another operand."""

    window: Instruction
    operations: tuple[int, ...]


def hoist(program: Program) -> Program:
    """Return the program with constants moved out of those windows and delays that become one."""
    while not program.domain.continuous and (moves := _moves(program)):
        program = _move_instructions(program, moves)
    return program


def _moves(program: Program) -> dict[int, _Move]:
    """Return the instructions to move, each of them equal to another one then."""
    alike = _alike(program)
    if not alike:  # most
        return {}
    found = [(place, program.instructions[place]) for place in alike]
    moves = {place: move for place, ins in found if (move := _move(program, ins)).operations}
    readers = Counter(move.window for move in moves.values())
    readers.update(ins for _, ins in found if ins in readers)
    return {place: move for place, move in moves.items() if readers[move.window] > 1}


def _alike(program: Program) -> list[int]:
    """Return the windows and delays that can become equal to another one: in most programs none."""
    by_length: dict[tuple[int, int], list[int]] = {}
    moved = _MOVED
    for place, record in enumerate(program.records):
        if record[0] in moved:
            by_length.setdefault((record[4], record[6]), []).append(place)
    found: list[int] = []
    for windows in by_length.values():
        if len(windows) > 1:
            roots = [_root(program, place) for place in windows]
            if len(set(roots)) < len(roots):
                seen = Counter(roots)
                found += [place for place, root in zip(windows, roots, strict=True) if seen[root] > 1]
    return sorted(found)


def _root(program: Program, window: int) -> int:
    """Return what the operand of a window is without all negations, sums and differences with constants."""
    records = program.records
    place = records[window][1]
    while records[place][0] in _LINEAR and (before := _variable(program, place)) is not None:
        place = before
    return place


def _move(program: Program, ins: Instruction) -> _Move:
    """Return the window of the first operand that is no sum or difference with a constant."""
    operations: list[int] = []
    assert ins.a is not None
    window, place = ins, ins.a
    while (before := _variable(program, place)) is not None:
        operation = program.instructions[place]
        # A fill that is never visible may be any number; others move as the values do.
        late = ins.lag == operation.lag + ins.n
        if ins.opcode == "shift" and not isinf(ins.x) and not late:
            break
        if operation.opcode == "neg" or (operation.opcode == "sub" and before == operation.b):
            fill = -window.x if isinf(window.x) else window.x
            window = window._replace(opcode=_OPPOSITE[window.opcode], x=fill)
        operations.append(place)
        place = before
    return _Move(window._replace(a=place), tuple(reversed(operations)))


def _variable(program: Program, place: int) -> int | None:
    """Return the operand of a negation, or of a sum or difference with a finite constant, that is no constant."""
    code, a, b, *_ = program.records[place]
    if code == _NEG:
        return a
    if code not in (_ADD, _SUB):
        return None
    fixed = _is_finite_constant(program, b)
    if fixed == _is_finite_constant(program, a):
        return None
    return a if fixed else b


def _is_finite_constant(program: Program, place: int) -> bool:
    record = program.records[place]
    return record[0] == _CONST and isfinite(record[5]) and place not in program.parametric


def _move_instructions(program: Program, moves: dict[int, _Move]) -> Program:
    """Return the program with these instructions moved, and without operations that nothing reads any more."""
    unread = _unread(program, moves)
    instructions: list[Instruction] = []
    sources: list[int] = []  # for each instruction, the one of the old program that it was made from
    places: dict[int, int] = {}  # of instructions of the old program in the new one
    index_of: dict[Instruction, int] = {}

    def emit(ins: Instruction, source: int) -> int:
        # A parameter is never merged with another constant.
        index = None if ins.opcode == "const" else index_of.get(ins)
        if index is None:
            index = index_of[ins] = len(instructions)
            instructions.append(ins)
            sources.append(source)
        return index

    for place, ins in enumerate(program.instructions):
        if place in unread:
            continue
        move = moves.get(place, _Move(ins, ()))
        value = emit(_reading(move.window, places), place)
        for each in move.operations:
            value = emit(_of(program, each, value, places, ins.lag), place)
        places[place] = value
    return replace(
        program,
        records=records_of(instructions),
        origins=Origins(lambda: [program.origins[source] for source in sources]),
        outputs=tuple(places[output] for output in program.outputs),
        value_of=Deferred(
            lambda: [(formula, places[old]) for formula, old in program.value_of.items() if old in places]
        ),
        parametric={places[old]: name for old, name in program.parametric.items() if old in places},
        calls=tuple(
            replace(site, operands=tuple(places[each] for each in site.operands)) for site in program.calls
        ),
    )


def _of(program: Program, operation: int, value: int, places: Mapping[int, int], lag: int) -> Instruction:
    """Return an operation of ``value``, a place in the new program, instead of its variable operand."""
    ins, variable = program.instructions[operation], _variable(program, operation)
    a, b = (None if each is None else value if each == variable else places[each] for each in (ins.a, ins.b))
    return ins._replace(a=a, b=b, lag=lag)


def _reading(ins: Instruction, places: Mapping[int, int]) -> Instruction:
    """Return an instruction whose operands are at other places."""
    a, b = (None if each is None else places[each] for each in (ins.a, ins.b))
    return ins._replace(a=a, b=b)


def _unread(program: Program, moves: dict[int, _Move]) -> set[int]:
    """Return the operations that are read by instructions to be moved alone."""
    reads: Counter[int | None] = Counter(program.outputs)
    for site in program.calls:
        reads.update(site.operands)
    for place, ins in enumerate(program.instructions):
        if place not in moves:
            reads.update(each for each in (ins.a, ins.b) if each is not None)
    reads.update(move.window.a for move in moves.values())
    unread: set[int] = set()
    # From the last to the first: what only an unread operation reads is not read either.
    for place in sorted({each for move in moves.values() for each in move.operations}, reverse=True):
        if not reads[place]:
            unread.add(place)
            ins = program.instructions[place]
            reads.subtract([each for each in (ins.a, ins.b) if each is not None])
    return unread
