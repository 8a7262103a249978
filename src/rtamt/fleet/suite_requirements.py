"""The requirements of a suite: their names, and what a report shows of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from rtamt.errors import UsageError, shown
from rtamt.language.printing.printer import excerpt
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.specification import Specification
from rtamt.specification_recorded import Optional


@dataclass(frozen=True, slots=True)
class SuiteRequirement:
    """A requirement of a suite: its unique ``name``, and what a report shows of it.

    ``optional``: the variables that recordings may lack.
    """

    name: str
    formula: str
    description: str = ""
    severity: str = "error"
    optional: Optional = field(default_factory=Optional)

    @staticmethod
    def of(name: str, spec: Specification) -> SuiteRequirement:
        """Return what a report shows of a specification with one requirement."""
        known = spec.document.requirements[0]
        return SuiteRequirement(
            name, excerpt(spec.formula), known.description, known.severity, spec._optional
        )


def named_requirements(specs: Any) -> list[tuple[str, Specification]]:
    """Return every requirement of every specification, with a unique name."""
    given: list[tuple[str | None, Any]]
    if isinstance(specs, Specification):
        given = [(None, specs)]
    elif isinstance(specs, Mapping):
        given = [(str(name), spec) for name, spec in specs.items()]
    elif isinstance(specs, str) or not hasattr(specs, "__iter__"):
        raise UsageError(f"a suite takes specifications, got {shown(specs)}; rtamt.parse reads text")
    else:
        given = [(None, spec) for spec in specs]
    found: list[tuple[str, Specification]] = []
    for label, spec in given:
        if not isinstance(spec, Specification):
            raise UsageError(f"a suite takes specifications, got {shown(spec)}; rtamt.parse reads text")
        several = spec.document.requirements
        for known, one in zip(several, spec.requirements.values(), strict=True):
            own = known.name if known.explicit or len(several) > 1 else spec.name or excerpt(spec.formula)
            if label is not None:
                own = label if len(several) == 1 else f"{label}: {known.name}"
            found.append((own, one))
    if not found:
        raise UsageError("a suite needs one specification or more")
    taken = Counter(name for name, _ in found)
    seen: Counter[str] = Counter()
    unique = []
    for name, spec in found:
        seen[name] += 1
        unique.append((name if taken[name] == 1 else f"{name} ({seen[name]})", spec))
    return unique
