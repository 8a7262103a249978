"""Two versions of a specification: on which traces their verdicts differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis.analysis import Analysis, about_unbounded
from rtamt.analysis.encoder import NotCoveredError
from rtamt.analysis.study import LIMIT, SAMPLES, Conclusion, Part, Study, trace_text, unbounded

if TYPE_CHECKING:
    from rtamt.specification import Specification


def diff(old: Specification, new: Specification, *, samples: int = SAMPLES, limit: float = LIMIT) -> Analysis:
    """Compare the requirements of two versions, by name: a trace on which both differ is a finding.

    Added and removed requirements are findings, too. Traces stay within the limits that the new version declares, for
    signals that it does not have within those of the old one. Arguments are those of :func:`analyze`.

    >>> import rtamt
    >>> from rtamt.analysis import diff
    >>> old = rtamt.parse("require R1: always(x <= 5); require R2: always(x >= 1)")
    >>> new = rtamt.parse("require R1: always(x <= 4); require R2: not eventually(x < 1)")
    >>> for conclusion in diff(old, new).conclusions:
    ...     print(conclusion.names, conclusion.sentence.partition(":")[0])
    ('R1',) the new version is stricter
    ('R2',) they agree
    """
    study = Study([old, new], samples, limit)
    found: list[Conclusion] = []
    endless: list[str] = []
    for name, one in new.requirements.items():
        if name not in old.requirements:
            found.append(Conclusion("same", (name,), False, "it is only in the new version", True))
            continue
        before, after = Part(name, old.requirements[name]), Part(name, one)
        try:
            for part in (before, after):
                study.require_covered(part.spec.formula, part.spec)
        except NotCoveredError as error:
            found.append(_uncovered(before, after, error))
            continue
        found.append(_compared(study, before, after))
        if unbounded(before.spec.formula) or unbounded(after.spec.formula):
            endless.append(name)
    removed = [name for name in old.requirements if name not in new.requirements]
    found += [Conclusion("same", (name,), False, "it is only in the old version", True) for name in removed]
    notes = about_unbounded(endless, study.samples)
    return Analysis(study.samples, study.period, tuple(found), tuple(notes))


def _uncovered(before: Part, after: Part, error: NotCoveredError) -> Conclusion:
    """Return what is known of a requirement that the analysis does not cover: whether it was changed."""
    names = (after.name,)
    if before.spec.formula == after.spec.formula:
        return Conclusion("same", names, True, "they agree: the formula is the same")
    return Conclusion("same", names, None, f"the formula was changed, and {error.message}")


def _compared(study: Study, before: Part, after: Part) -> Conclusion:
    """Return whether two versions of a requirement agree, and which one is stricter."""
    names = (after.name,)
    weaker, stricter = study.implies(before, after), study.implies(after, before)
    for one in (weaker, stricter):
        if one.holds is None:
            return Conclusion("same", names, None, one.sentence, witness=one.witness)
    if weaker.holds and stricter.holds:
        return Conclusion("same", names, True, study.equivalent(before, after).sentence)
    shown = stricter if weaker.holds else weaker
    how = "looser" if weaker.holds else "stricter" if stricter.holds else "neither stricter nor looser"
    sentence = (
        f"{trace_text(shown.witness)} violates the old version and satisfies the new one"
        if shown is stricter
        else f"{trace_text(shown.witness)} satisfies the old version and violates the new one"
    )
    return Conclusion("same", names, False, f"the new version is {how}: {sentence}", True, shown.witness)
