"""Draw the pattern library: of each pattern a trace that satisfies it and one that violates it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from matplotlib.figure import Figure

import rtamt

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

Time = Literal["discrete", "dense"]
#: What both traces of a pattern share, and the signals in which they differ: satisfied, violated. A character is a
#: sample of a Boolean, one second after the one before.
Example = tuple[dict[str, str], dict[str, str], dict[str, str]]

EXAMPLES: Mapping[str, Mapping[str, Example]] = {
    "absence": {
        "absence(p)": ({}, {"p": "0000000000"}, {"p": "0000100000"}),
        "absence_before(p, r)": ({"r": "0000010000"}, {"p": "0000001100"}, {"p": "0010000000"}),
        "absence_after(p, q)": ({"q": "0001000000"}, {"p": "0110000000"}, {"p": "0000001000"}),
        "absence_between(p, q, r)": (
            {"q": "0100001000", "r": "0001000000"},
            {"p": "1000110010"},
            {"p": "1010110010"},
        ),
        "absence_until(p, q, r)": (
            {"q": "0100001000", "r": "0001000000"},
            {"p": "1000110000"},
            {"p": "1000110010"},
        ),
    },
    "universality": {
        "universality(p)": ({}, {"p": "1111111111"}, {"p": "1111011111"}),
        "universality_before(p, r)": ({"r": "0000010000"}, {"p": "1111100000"}, {"p": "1101100000"}),
        "universality_after(p, q)": ({"q": "0001000000"}, {"p": "0001111111"}, {"p": "0001110111"}),
        "universality_between(p, q, r)": (
            {"q": "0100001000", "r": "0001000000"},
            {"p": "0110000100"},
            {"p": "0100000100"},
        ),
        "universality_until(p, q, r)": (
            {"q": "0100001000", "r": "0001000000"},
            {"p": "0110001111"},
            {"p": "0110001101"},
        ),
    },
    "existence": {
        "existence(p)": ({}, {"p": "0000010000"}, {"p": "0000000000"}),
        "existence_before(p, r)": ({"r": "0000001000"}, {"p": "0010000000"}, {"p": "0000000100"}),
        "existence_after(p, q)": ({"q": "0001000000"}, {"p": "0000001000"}, {"p": "0100000000"}),
        "existence_between(p, q, r)": (
            {"q": "0100001000", "r": "0000100000"},
            {"p": "0010000000"},
            {"p": "1000010000"},
        ),
        "existence_until(p, q, r)": (
            {"q": "0100001000", "r": "0000100000"},
            {"p": "0010000010"},
            {"p": "0010000000"},
        ),
    },
    "bounded_existence": {
        "bounded_existence(p, 2)": ({}, {"p": "0110010000"}, {"p": "0110010100"}),
        "bounded_existence_before(p, 2, r)": ({"r": "0000000100"}, {"p": "0101000101"}, {"p": "0101010000"}),
        "bounded_existence_after(p, 1, q)": ({"q": "0001000000"}, {"p": "1010010000"}, {"p": "1010010100"}),
        "bounded_existence_between(p, 1, q, r)": (
            {"q": "0100000100", "r": "0000010000"},
            {"p": "1001000101"},
            {"p": "0101000101"},
        ),
        "bounded_existence_until(p, 1, q, r)": (
            {"q": "0100000100", "r": "0000010000"},
            {"p": "1001000100"},
            {"p": "1001000101"},
        ),
    },
    "response": {
        "response(p, s)": ({"p": "0100010000"}, {"s": "0001000100"}, {"s": "0001000000"}),
        "response_before(p, s, r)": (
            {"r": "0000001000", "p": "0100000010"},
            {"s": "0001000000"},
            {"s": "0000000100"},
        ),
        "response_after(p, s, q)": (
            {"q": "0001000000", "p": "0100100000"},
            {"s": "0000001000"},
            {"s": "0010000000"},
        ),
        "response_between(p, s, q, r)": (
            {"q": "0100000000", "r": "0000001000", "p": "0010000100"},
            {"s": "0000100000"},
            {"s": "0000000100"},
        ),
        "response_until(p, s, q, r)": (
            {"q": "0100001000", "r": "0000010000", "p": "0010000100"},
            {"s": "0001000010"},
            {"s": "0001000000"},
        ),
    },
    "precedence": {
        "precedence(p, s)": ({"s": "0010000000"}, {"p": "0000100100"}, {"p": "0100100000"}),
        "precedence_before(p, s, r)": (
            {"r": "0000001000", "s": "0010000000"},
            {"p": "0000100000"},
            {"p": "0100000000"},
        ),
        "precedence_after(p, s, q)": (
            {"q": "0001000000", "p": "0100001000"},
            {"s": "0000100000"},
            {"s": "0100000000"},
        ),
        "precedence_between(p, s, q, r)": (
            {"q": "0100000000", "r": "0000001000", "p": "0001000000"},
            {"s": "0010000000"},
            {"s": "1000100000"},
        ),
        "precedence_until(p, s, q, r)": (
            {"q": "0100000000", "r": "0000000000", "p": "0000100000"},
            {"s": "0010000000"},
            {"s": "1000000000"},
        ),
    },
    "response_chain": {
        "response_chain(p, s, t)": (
            {"p": "0100010000", "s": "0001001000"},
            {"t": "0000100010"},
            {"t": "0000100000"},
        ),
        "response_chain_before(p, s, t, r)": (
            {"r": "0000001000", "p": "0100000010", "s": "0010000000"},
            {"t": "0000100000"},
            {"t": "0000000100"},
        ),
        "response_chain_after(p, s, t, q)": (
            {"q": "0001000000", "p": "0100100000", "s": "0010010000"},
            {"t": "0000000100"},
            {"t": "0001000000"},
        ),
        "response_chain_between(p, s, t, q, r)": (
            {"q": "0100000000", "r": "0000001000", "p": "0010000100", "s": "0001000000"},
            {"t": "0000100000"},
            {"t": "0000000100"},
        ),
        "response_chain_until(p, s, t, q, r)": (
            {"q": "0100001000", "r": "0000010000", "p": "0010000100", "s": "0001000010"},
            {"t": "0000100001"},
            {"t": "0000100000"},
        ),
    },
    "chain_response": {
        "chain_response(s, t, p)": (
            {"s": "0100000100", "t": "0001000000"},
            {"p": "0000010000"},
            {"p": "0010000000"},
        ),
        "chain_response_before(s, t, p, r)": (
            {"r": "0000001000", "s": "0100000000", "t": "0001000000"},
            {"p": "0000010000"},
            {"p": "0000000100"},
        ),
        "chain_response_after(s, t, p, q)": (
            {"q": "0010000000", "s": "1001000000", "t": "0100010000"},
            {"p": "0000000100"},
            {"p": "0000100000"},
        ),
        "chain_response_between(s, t, p, q, r)": (
            {"q": "0100000000", "r": "0000001000", "s": "0010000000", "t": "0001000000"},
            {"p": "0000100000"},
            {"p": "0000000100"},
        ),
        "chain_response_until(s, t, p, q, r)": (
            {"q": "0100001000", "r": "0000010000", "s": "0010000100", "t": "0001000010"},
            {"p": "0000100001"},
            {"p": "0000100000"},
        ),
    },
    "precedence_chain": {
        "precedence_chain(p, s, t)": (
            {"s": "0100000000", "t": "0001000000"},
            {"p": "0000100100"},
            {"p": "0010000100"},
        ),
        "precedence_chain_before(p, s, t, r)": (
            {"r": "0000001000", "s": "0100000000", "t": "0001000000"},
            {"p": "0000100100"},
            {"p": "0010000000"},
        ),
        "precedence_chain_after(p, s, t, q)": (
            {"q": "0010000000", "t": "0000010000", "p": "0100000100"},
            {"s": "0001000000"},
            {"s": "0100000000"},
        ),
        "precedence_chain_between(p, s, t, q, r)": (
            {"q": "0100000000", "r": "0000000100", "t": "0000100000", "p": "0000010010"},
            {"s": "0010000000"},
            {"s": "1000000000"},
        ),
        "precedence_chain_until(p, s, t, q, r)": (
            {"q": "0010000000", "r": "0000000000", "t": "0000010000", "p": "0000000100"},
            {"s": "0001000000"},
            {"s": "1000000000"},
        ),
    },
    "chain_precedence": {
        "chain_precedence(s, t, p)": (
            {"s": "0001000100", "t": "0000010000"},
            {"p": "0100000000"},
            {"p": "0000100000"},
        ),
        "chain_precedence_before(s, t, p, r)": (
            {"r": "0000001000", "s": "0010000000", "t": "0000100000"},
            {"p": "0100000000"},
            {"p": "0001000000"},
        ),
        "chain_precedence_after(s, t, p, q)": (
            {"q": "0010000000", "s": "0000010000", "t": "0000000100"},
            {"p": "0001000000"},
            {"p": "0100000000"},
        ),
        "chain_precedence_between(s, t, p, q, r)": (
            {"q": "0100000000", "r": "0000000100", "s": "0001000000", "t": "0000010000"},
            {"p": "0010000000"},
            {"p": "1000000000"},
        ),
        "chain_precedence_until(s, t, p, q, r)": (
            {"q": "0100000000", "r": "0000000000", "s": "0001000000", "t": "0000010000"},
            {"p": "0010000000"},
            {"p": "1000000000"},
        ),
    },
    "times": {
        "response_within(p, s, 2s)": ({"p": "0100010000"}, {"s": "0001010000"}, {"s": "0001000010"}),
        "invariance(p, s, 2s)": ({"p": "0100000000"}, {"s": "0111000000"}, {"s": "0110000000"}),
        "recurrence(p, 3s)": ({}, {"p": "0010010001"}, {"p": "0010000101"}),
        "minimum_duration(p, 2s)": ({}, {"p": "0111001111"}, {"p": "0110001111"}),
        "maximum_duration(p, 2s)": ({}, {"p": "0110001100"}, {"p": "0110011100"}),
    },
}

_COLORS = {"q": "#4c78a8", "r": "#b279a2", "p": "#333333", "s": "#e08a2e", "t": "#54a24b"}
_VERDICTS = {True: ("satisfied", "#e7f4e8"), False: ("violated", "#fbe9e7")}


def specification(*calls: str, time: Time = "discrete") -> rtamt.Specification:
    """Return the specification that requires patterns of the Booleans p, q, r, s and t."""
    requirements = "".join(f"\nrequire R{number}: {call}" for number, call in enumerate(calls))
    return rtamt.parse(
        f'import "patterns.stl" bool p; bool q; bool r; bool s; bool t;{requirements}', time=time
    )


def signals(trace: Mapping[str, str], time: Time = "discrete") -> dict[str, Sequence[object]]:
    """Return the samples of a trace; a signal that it does not have is false."""
    size = max(map(len, trace.values()))
    values = {name: [value == "1" for value in trace.get(name, "0" * size)] for name in "pqrst"}
    return {name: list(enumerate(each)) if time == "dense" else each for name, each in values.items()}


def draw(images: Path) -> None:
    """Draw one image for each group of patterns."""
    for group, patterns in EXAMPLES.items():
        figure = Figure(figsize=(10, 1.35 * len(patterns)), layout="constrained")
        axes = figure.subplots(len(patterns), 2, squeeze=False)
        for row, (call, (shared, *different)) in zip(axes, patterns.items(), strict=True):
            for ax, own in zip(row, different, strict=True):
                _panel(
                    ax, call, {name: {**shared, **own}[name] for name in "qrpst" if name in {**shared, **own}}
                )
        figure.savefig(images / f"patterns_{group}.png", dpi=80)


def _panel(ax: Axes, call: str, trace: Mapping[str, str]) -> None:
    """Draw Booleans as steps above each other, on the colour of the verdict."""
    verdict, background = _VERDICTS[bool(specification(call).evaluate(signals(trace)).satisfied)]
    ax.set_facecolor(background)
    for level, (name, values) in enumerate(reversed(trace.items())):
        samples = [int(value) for value in values]
        heights = [level + 0.7 * value for value in (*samples, samples[-1])]
        ax.step(range(len(heights)), heights, where="post", color=_COLORS[name], linewidth=1.6)
    ax.set_yticks([level + 0.3 for level in range(len(trace))], [*reversed(trace)], fontsize=8)
    ax.set_xticks(range(0, 11, 2))
    ax.set_xlim(0, 10)
    ax.set_ylim(-0.25, len(trace))
    ax.tick_params(labelsize=7, length=2)
    ax.set_title(f"{call}: {verdict}", fontsize=8, family="monospace", loc="left")
    ax.spines[["top", "right"]].set_visible(False)
