"""A short decision list over templates that separates good recordings from bad ones."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices
from rtamt.language.formula import Var
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.mining.classifier_templates import builtin, features, own
from rtamt.mining.decision_list import DecisionList, learn_list
from rtamt.mining.mine import named_recordings
from rtamt.mining.region import Budget, Region, Spent, require_count
from rtamt.specification_loader import parse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from rtamt.mining.classifier_templates import Template
    from rtamt.mining.decision_list import Rule
    from rtamt.settings import EvaluationSettings
    from rtamt.specification import Specification

    Bits = NDArray[np.bool_]

#: How many evaluations of a recording are made at most, where no budget is given.
EVALUATIONS = 1_000_000


@dataclass(frozen=True)
class Classifier:
    """A decision list learned from all recordings, and how well such lists do on recordings they were not learned from.

    ``accuracy``: the share of the recordings that were right when the list was learned without them, by
    cross-validation in ``folds`` parts that ``seed`` chooses. ``baseline``: the share of the class of most recordings.
    ``predicted``: which recordings the engine finds good, by the specification of the list. ``templates``: how many
    templates there are. ``undefined``: how many built-in ones have no value on some recording and were left out.
    """

    rules: tuple[Rule, ...]
    default: bool
    recordings: Mapping[str, bool]
    predicted: Mapping[str, bool]
    accuracy: float
    baseline: float
    folds: int
    seed: int
    templates: int
    undefined: int
    values: NDArray[np.float64]

    @property
    def training(self) -> float:
        """The share of the recordings that are right, of those from which the list was learned."""
        return sum(self.predicted[name] == good for name, good in self.recordings.items()) / len(
            self.recordings
        )

    @cached_property
    def text(self) -> str:
        """The list as a specification file, whose requirement is satisfied where a recording is good."""
        return _text(self.rules, self.default, self.recordings)

    @property
    def specification(self) -> Specification:
        """The specification that is satisfied where a recording is good."""
        return parse(self.text)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return {
            "rules": [
                {
                    "formula": rule.text,
                    "class": _class(rule.good),
                    "covered": {"good": rule.covered[0], "bad": rule.covered[1]},
                }
                for rule in self.rules
            ],
            "default": _class(self.default),
            "accuracy": self.accuracy,
            "baseline": self.baseline,
            "training": self.training,
            "folds": self.folds,
            "seed": self.seed,
            "templates": self.templates,
            "undefined": self.undefined,
            "recordings": [
                {"name": name, "class": _class(good), "predicted": _class(self.predicted[name])}
                for name, good in self.recordings.items()
            ],
            "specification": self.text,
        }

    def plot(self, figure: Any = None) -> Any:
        """Plot the tight value of each recording for each rule; returns the figure. Needs ``rtamt[plot]``."""
        from rtamt.mining.plot import strips

        return strips(self, figure)

    def __str__(self) -> str:
        lines = [
            f"{'if' if not place else 'else if'} {rule.text} then {_class(rule.good)}"
            for place, rule in enumerate(self.rules)
        ]
        return "\n".join([*lines, f"else {_class(self.default)}" if lines else _class(self.default)])

    def __repr__(self) -> str:
        count = len(self.rules)
        return f"<{count} rule{'' if count == 1 else 's'}: accuracy {self.accuracy:.0%}, baseline {self.baseline:.0%}>"


def classify(
    good: Mapping[str, Any] | Iterable[Any],
    bad: Mapping[str, Any] | Iterable[Any],
    *,
    signals: Sequence[str] | None = None,
    templates: Iterable[Specification] | None = None,
    rules: int = 3,
    folds: int = 5,
    seed: int = 0,
    evaluations: int = EVALUATIONS,
    timeout: float | None = None,
    progress: Callable[[int], None] | None = None,
    **reading: Unpack[EvaluationSettings],
) -> Classifier:
    """Learn a decision list of at most ``rules`` rules that separates good recordings from bad ones.

    ``signals``: the variables of the templates, by default all that every recording has. ``templates``:
    specifications whose requirements have one threshold each, in place of those over each signal and each pair. Signals
    may be infinite; of the latter templates, those without a value on some recording, such as the difference of two
    infinite signals, are left out.
    ``evaluations``, ``timeout`` and ``progress`` as for :func:`mine`; the other settings are those of
    :meth:`Specification.evaluate` in discrete time. The result is the same each time.

    >>> from rtamt.mining import classify
    >>> good = [{"x": [0, top, 1]} for top in (2, 2.5, 3, 3.5)]
    >>> bad = [{"x": [0, top, 1]} for top in (5, 6, 7)]
    >>> found = classify(good, bad, folds=3)
    >>> print(found)
    if always(x <= 4) then good
    else bad
    >>> round(found.accuracy, 2), round(found.baseline, 2)
    (0.86, 0.57)
    """
    named = _label(named_recordings(good, "good"), named_recordings(bad, "bad"))
    recordings, labels = (
        {name: data for name, (data, _) in named.items()},
        {n: g for n, (_, g) in named.items()},
    )
    _check(labels, rules, folds)
    budget = Budget(evaluations, timeout, progress)
    try:
        if templates is not None:
            chosen = own([templates] if hasattr(templates, "requirements") else templates)
        else:
            names = _signals(recordings, signals)
            chosen = builtin(names, *_common_sampling(recordings, names, reading, budget))
        if not chosen:
            raise UsageError("there is no template; give specifications with a parameter each")
        table = features(chosen, recordings, reading, budget)
        defined = [column for column in range(len(chosen)) if not np.isnan(table[:, column]).any()]
        undefined = len(chosen) - len(defined)
        chosen, table = [chosen[column] for column in defined], table[:, defined]
        is_good = np.array(list(labels.values()))
        found = learn_list(chosen, table, is_good, rules)
        accuracy, baseline = _cross_validate(chosen, table, is_good, rules, folds, seed)
        predicted = _predict(found, labels, recordings, reading, budget)
    except Spent:
        raise UsageError("the budget was spent before the rules were learned; give a larger one") from None
    return Classifier(
        found.rules,
        found.default,
        labels,
        predicted,
        accuracy,
        baseline,
        folds,
        seed,
        len(chosen),
        undefined,
        table,
    )


def _label(good: dict[str, Any], bad: dict[str, Any]) -> dict[str, tuple[Any, bool]]:
    """Return recordings with their class; numbered ones are called ``good 0``, ``bad 0`` and so on."""
    if set(good) & set(bad):
        good = {f"good {name}": data for name, data in good.items()}
        bad = {f"bad {name}": data for name, data in bad.items()}
    return {**{n: (data, True) for n, data in good.items()}, **{n: (data, False) for n, data in bad.items()}}


def _check(labels: Mapping[str, bool], rules: int, folds: int) -> None:
    require_count("rules", rules, 1)
    require_count("folds", folds, 2)
    for good in (True, False):
        count = sum(label == good for label in labels.values())
        if count < folds:
            raise UsageError(
                f"{folds} folds need {folds} {_class(good)} recordings or more, and there are {count}; "
                f"give more recordings" + (f", or {count} folds" if count > 1 else "")
            )


def _class(good: bool) -> str:
    return "good" if good else "bad"


def _signals(recordings: Mapping[str, Any], given: Sequence[str] | None) -> list[str]:
    """Return the variables of templates, which every recording has."""
    every = [
        [name for name in (data.names if hasattr(data, "names") else data) if name != "time"]
        for data in recordings.values()
    ]
    common = [name for name in every[0] if all(name in names for names in every)]
    for name in given or ():
        if name not in common:
            raise UsageError(f"no signal '{name}' is in every recording{choices(name, common, 'signals')}")
    if not common:
        raise UsageError("no signal is in every recording; give recordings of the same signals")
    return list(dict.fromkeys(given)) if given else common


def _common_sampling(
    recordings: Mapping[str, Any], names: Sequence[str], reading: Mapping[str, Any], budget: Budget
) -> tuple[Fraction | None, Fraction]:
    """Return the sampling period, None if recordings have different ones, and the shortest duration."""
    spec = parse(" and ".join(f"{Var(name)} > 0" for name in names))
    region = Region(spec, recordings, reading, budget)
    traces = [region.trace(name) for name in recordings]
    periods = {trace.step for trace in traces}
    return periods.pop() if len(periods) == 1 else None, min(trace.last * trace.step for trace in traces)


def _cross_validate(
    templates: Sequence[Template], table: NDArray[np.float64], good: Bits, rules: int, folds: int, seed: int
) -> tuple[float, float]:
    """Return the share of recordings that are right by a list that was learned without them, and of the majority."""
    part = np.empty(len(good), int)
    draw = np.random.default_rng(seed)
    for label in (True, False):
        places = draw.permutation(np.flatnonzero(good == label))
        part[places] = np.arange(len(places)) % folds
    right = 0
    for fold in range(folds):
        held = part == fold
        found = learn_list(templates, table[~held], good[~held], rules)
        right += int((found.predicted(table[held]) == good[held]).sum())
    return right / len(good), max(float(good.mean()), float((~good).mean()))


def _predict(
    found: DecisionList,
    labels: Mapping[str, bool],
    recordings: Mapping[str, Any],
    reading: Mapping[str, Any],
    budget: Budget,
) -> dict[str, bool]:
    """Return the predictions of the engine, by the specification of a list."""
    if not found.rules:
        return dict.fromkeys(recordings, found.default)
    spec = parse(_text(found.rules, found.default, labels))
    return {name: Region(spec, {name: data}, reading, budget).holds({}) for name, data in recordings.items()}


def _text(rules: Sequence[Rule], default: bool, labels: Mapping[str, bool]) -> str:
    count = sum(labels.values())
    lines = [f"// Learned from {count} good and {len(labels) - count} bad recordings."]
    for place, rule in enumerate(rules, 1):
        good, bad = rule.covered
        lines.append(f"// {_class(rule.good)} if it holds: {good} good and {bad} bad recordings")
        lines.append(f"rule_{place} = {rule.text}")
    formula = DecisionList(tuple(rules), default).formula()
    return "\n".join([*lines, f'require GOOD "the recording is good": {formula}', ""])
