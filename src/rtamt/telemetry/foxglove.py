"""A layout of Foxglove for the topics of a result: plots, the verdicts over time, and a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.telemetry.content import content_of
from rtamt.telemetry.messages import SUMMARY, signal_topic, topic

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.results import Result
    from rtamt.telemetry.content import Bounded, Content, Finding, Variable


def layout(result: Result | Mapping[str, Result], *, bounds: bool = False) -> dict[str, Any]:
    """Return a layout of Foxglove, for ``json.dump``, that shows the file of :func:`write_mcap`.

    Each requirement has a plot of its signals and one of its robustness, in tabs if there are several requirements.
    Next to them are the verdicts over time, a table of the requirements, and the violations. ``bounds``: as for
    :func:`write_mcap`; the bounds at the start are then in the plot of the robustness.

    >>> import rtamt
    >>> found = layout(rtamt.parse("require LOW: always(x >= 3)").evaluate({"x": [5, 1]}))
    >>> [path["value"] for path in found["configById"]["Plot!robustness-LOW"]["paths"]]
    ['/rtamt/requirements/LOW/robustness.value']
    """
    return layout_of(content_of(result, bounds=bounds))


def layout_of(content: Content) -> dict[str, Any]:
    """Return a layout for what is exported of a result."""
    panels: dict[str, Any] = {}
    variables = {variable.key: variable for variable in content.variables}
    pages = [(finding.name, _page(finding, variables, panels)) for finding in content.findings]
    left: Any = pages[0][1]
    if len(pages) > 1:
        left = "Tab!requirements"
        panels[left] = {
            "activeTabIdx": 0,
            "tabs": [{"title": title, "layout": page} for title, page in pages],
        }
    panels["StateTransitions!verdicts"] = _panel(
        "Verdicts",
        {
            "isSynced": True,
            "paths": [
                {"label": finding.name, **_path(f"{topic(finding, 'verdict')}.verdict")}
                for finding in content.findings
            ],
        },
    )
    panels["Table!summary"] = _panel("Requirements", {"topicPath": f"{SUMMARY}.requirements"})
    lower = [_violations(finding, panels) for finding in content.findings if finding.episodes]
    right = _stack(["StateTransitions!verdicts", "Table!summary", *lower[:1]])
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"first": left, "second": right, "direction": "row", "splitPercentage": 60},
    }


def _page(finding: Finding, variables: Mapping[str, Variable], panels: dict[str, Any]) -> Any:
    """Add the plots of a requirement; return how they are arranged."""
    signals, robustness = f"Plot!signals-{finding.key}", f"Plot!robustness-{finding.key}"
    topics = {"value": "robustness", "lower": "interval", "upper": "interval"}
    paths = [f"{topic(finding, topics[field])}.{field}" for field in _fields(finding.robustness)]
    if finding.known is not None:
        paths += [f"{topic(finding, 'known')}.{end}" for end in ("lower", "upper")]
    panels[robustness] = _plot(f"{finding.name}: robustness", paths)
    if not finding.variables:
        return robustness
    paths = [
        f"{signal_topic(key)}.{field}"
        for key in finding.variables
        for field in _fields(variables[key].samples)
    ]
    panels[signals] = _plot(f"{finding.name}: signals", paths)
    return _stack([signals, robustness])


def _fields(samples: Bounded) -> list[str]:
    """Return the fields of messages that show samples."""
    exact = samples.lower == samples.upper
    return (["value"] if exact.any() else []) + ([] if exact.all() else ["lower", "upper"])


def _plot(title: str, paths: Sequence[str]) -> dict[str, Any]:
    return _panel(
        title,
        {
            "paths": [{"enabled": True, **_path(path)} for path in paths],
            "showXAxisLabels": True,
            "showYAxisLabels": True,
            "showLegend": True,
            "legendDisplay": "top",
            "showPlotValuesInLegend": True,
            "isSynced": True,
            "xAxisVal": "timestamp",
            "sidebarDimension": 32 + 24 * len(paths),  # the height of the legend
        },
    )


def _violations(finding: Finding, panels: dict[str, Any]) -> str:
    """Add the messages about the violations of a requirement; return the name of the panel."""
    name = f"RawMessages!violations-{finding.key}"
    panels[name] = _panel(
        f"{finding.name}: violations",
        {
            "topicPath": topic(finding, "violations"),
            "diffEnabled": False,
            "diffMethod": "custom",
            "diffTopicPath": "",
            "showFullMessageForDiff": False,
        },
    )
    return name


def _panel(title: str, config: dict[str, Any]) -> dict[str, Any]:
    return {"foxglovePanelTitle": title, **config}


def _path(value: str) -> dict[str, Any]:
    return {"value": value, "timestampMethod": "receiveTime"}


def _stack(panels: Sequence[Any]) -> Any:
    """Return panels of equal height, one above the other."""
    first, *rest = panels
    if not rest:
        return first
    return {
        "first": first,
        "second": _stack(rest),
        "direction": "column",
        "splitPercentage": round(100 / len(panels), 2),
    }
