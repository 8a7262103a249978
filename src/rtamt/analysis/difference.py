"""Two versions of a specification: on which traces their verdicts differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis.analysis import Analysis, unbounded_note
from rtamt.analysis.bounded_checker import (
    LIMIT,
    SAMPLES,
    BoundedChecker,
    Conclusion,
    Part,
    trace_text,
    unbounded,
)
from rtamt.analysis.encoder import NotCoveredError
from rtamt.language.printing.printer import number

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.document import Declaration
    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.specification import Specification

_SAME = "they agree: the formula is the same"


def diff(old: Specification, new: Specification, *, samples: int = SAMPLES, limit: float = LIMIT) -> Analysis:
    """Compare the requirements of two versions, by name: a trace on which both differ is a finding.

    Added and removed requirements are findings, too, and declarations by which the versions read other data from the
    same recording: the sampling rule, recorded names and optional variables. Traces stay within the limits that the new
    version declares, for signals that it does not have within those of the old one. Arguments are those of
    :func:`analyze`.

    >>> import rtamt
    >>> from rtamt.analysis import diff
    >>> old = rtamt.parse("require R1: always(x <= 5); require R2: always(x >= 1)")
    >>> new = rtamt.parse("require R1: always(x <= 4); require R2: not eventually(x < 1)")
    >>> for conclusion in diff(old, new).conclusions:
    ...     print(conclusion.names, conclusion.sentence.partition(":")[0])
    ('R1',) the new version is stricter
    ('R2',) they agree
    """
    checker = BoundedChecker([old, new], samples, limit, versions=True)
    found = [Conclusion("data", (), False, each, True) for each in _about_data(old, new)]
    endless: list[str] = []
    for name, one in new.requirements.items():
        if name not in old.requirements:
            found.append(Conclusion("same", (name,), False, "it is only in the new version", True))
            continue
        before, after = Part(name, old.requirements[name]), Part(name, one)
        try:
            for part in (before, after):
                checker.require_covered(part.spec.formula, part.spec)
        except NotCoveredError as error:
            found.append(_compare_uncovered(before, after, error))
            continue
        found.append(_compare(checker, before, after))
        if unbounded(before.spec.formula) or unbounded(after.spec.formula):
            endless.append(name)
    removed = [name for name in old.requirements if name not in new.requirements]
    found += [Conclusion("same", (name,), False, "it is only in the old version", True) for name in removed]
    notes = [*unbounded_note(endless, checker.samples), *_about_limits(old, new)]
    return Analysis(checker.samples, checker.period, tuple(found), tuple(notes))


def _about_data(old: Specification, new: Specification) -> Iterator[str]:
    """Yield the differences of what the versions read from one recording."""
    rules = [_rule(spec.document.sampling) for spec in (old, new)]
    if rules[0] != rules[1]:
        yield f"the sampling rule has changed from {rules[0]} to {rules[1]}"
    for before, after in _common_variables(old, new):
        if _columns(before) != _columns(after):
            yield f"the recorded name of '{after.name}' has changed from {_columns(before)} to {_columns(after)}"
        if before.optional != after.optional:
            yield f"'{after.name}' is {'optional now' if after.optional else 'no longer optional'}"


def _about_limits(old: Specification, new: Specification) -> Iterator[str]:
    """Yield a note for each variable whose range or rate has changed, which no evaluation of a recording reads."""
    for before, after in _common_variables(old, new):
        for what, earlier, later in (
            ("range", before.range, after.range),
            ("rate", before.rate, after.rate),
        ):
            if earlier != later:
                yield (
                    f"the {what} of '{after.name}' has changed from {_ends(earlier)} to {_ends(later)}: "
                    f"traces stay in the new one"
                )


def _common_variables(old: Specification, new: Specification) -> Iterator[tuple[Declaration, Declaration]]:
    """Yield the variables that both versions declare."""
    before = {each.name: each for each in old.document.declarations if each.kind == "var"}
    for each in new.document.declarations:
        if each.kind == "var" and each.name in before:
            yield before[each.name], each


def _rule(sampling: Sampling | None) -> str:
    return "none" if sampling is None else f"'{sampling}'"


def _columns(declaration: Declaration) -> str:
    return " or ".join(f"'{name}'" for name in declaration.columns or (declaration.name,))


def _ends(limits: tuple[float, float] | None) -> str:
    return "none" if limits is None else f"[{number(limits[0])}, {number(limits[1])}]"


def _compare_uncovered(before: Part, after: Part, error: NotCoveredError) -> Conclusion:
    """Return the difference of a requirement that the analysis does not cover: whether it was changed."""
    names = (after.name,)
    if before.spec.formula == after.spec.formula:
        return Conclusion("same", names, True, _SAME)
    return Conclusion("same", names, None, f"the formula was changed, and {error.message}")


def _compare(checker: BoundedChecker, before: Part, after: Part) -> Conclusion:
    """Return whether two versions of a requirement agree, and which one is stricter."""
    names = (after.name,)
    weaker, stricter = checker.implies(before, after), checker.implies(after, before)
    for one in (weaker, stricter):
        if one.holds is None:
            if before.spec.formula == after.spec.formula:
                return Conclusion("same", names, True, _SAME)
            return Conclusion("same", names, None, one.sentence, witness=one.witness)
    if weaker.holds and stricter.holds:
        return Conclusion("same", names, True, checker.equivalent(before, after).sentence)
    shown = stricter if weaker.holds else weaker
    how = "looser" if weaker.holds else "stricter" if stricter.holds else "neither stricter nor looser"
    sentence = (
        f"{trace_text(shown.witness)} violates the old version and satisfies the new one"
        if shown is stricter
        else f"{trace_text(shown.witness)} satisfies the old version and violates the new one"
    )
    return Conclusion("same", names, False, f"the new version is {how}: {sentence}", True, shown.witness)
