"""SARIF as other programs read it: held to what the standard requires of the objects that we write."""

import json

import jsonschema
import pytest


def record(required, **properties):
    """Return the schema of an object that has these properties and no others."""
    return {
        "type": "object",
        "required": required.split(),
        "properties": properties,
        "additionalProperties": False,
    }


def listing(items, **more):
    return {"type": "array", "items": items, **more}


TEXT = {"type": "string"}
INDEX = {"type": "integer", "minimum": 0}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
KIND = {"enum": ["notApplicable", "pass", "fail", "review", "open", "informational"]}
MESSAGE = record("text", text=TEXT)
URI = {"type": "string", "pattern": r"^[A-Za-z0-9._~:/?#\[\]@!$&'()*+,;=%-]+$"}
PLACE = record("artifactLocation", artifactLocation=record("uri", uri=URI))
LOCATIONS = listing(record("physicalLocation", physicalLocation=PLACE), uniqueItems=True)
RULE = record("id", id=TEXT, shortDescription=MESSAGE)
DRIVER = record("name", name=TEXT, version=TEXT, rules=listing(RULE, uniqueItems=True))
NOTIFICATION = record(
    "message",
    message=MESSAGE,
    level=LEVEL,
    locations=LOCATIONS,
    associatedRule=record("id", id=TEXT, index=INDEX),
)
INVOCATION = record(
    "executionSuccessful",
    executionSuccessful={"type": "boolean"},
    toolExecutionNotifications=listing(NOTIFICATION),
)
RESULT = {
    **record(
        "message",
        ruleId=TEXT,
        ruleIndex=INDEX,
        kind=KIND,
        level=LEVEL,
        message=MESSAGE,
        locations=LOCATIONS,
        relatedLocations=LOCATIONS,
        properties={"type": "object"},
    ),
    # 3.27.10: what is no failure has the level "none".
    "if": {"properties": {"kind": {"const": "fail"}}},
    "else": {"properties": {"level": {"const": "none"}}},
}
#: SARIF 2.1.0: the file (section 3.13), run (3.14), tool (3.18), invocation (3.20), result (3.27), notification (3.58).
SARIF = record(
    "version runs",
    **{"$schema": URI},
    version={"const": "2.1.0"},
    runs=listing(
        record(
            "tool",
            tool=record("driver", driver=DRIVER),
            invocations=listing(INVOCATION),
            results=listing(RESULT),
        )
    ),
)


def check(report):
    jsonschema.Draft202012Validator(SARIF).validate(report)
    for run in report["runs"]:
        ids = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
        assert len(set(ids)) == len(ids)
        for result in run["results"]:
            assert ids[result["ruleIndex"]] == result["ruleId"]  # 3.27.6
        for told in run["invocations"][0]["toolExecutionNotifications"]:
            assert ids[told["associatedRule"]["index"]] == told["associatedRule"]["id"]


@pytest.fixture
def report(run, write):
    write("low.stl", "always(x >= 3)")
    write("good log.csv", "time,x\n0,5\n1,4\n")
    write("bad.csv", "time,x\n0,5\n1,1\n")
    found = run(
        "check", "low.stl", "good log.csv", "bad.csv", "none.csv", "--sarif", "report.sarif", "--quiet"
    )
    assert found.code == 2
    with open("report.sarif", encoding="utf-8") as file:
        return json.load(file)


def test_what_is_satisfied_violated_and_wrong_is_told_as_the_standard_has_it(report):
    check(report)
    assert [result["kind"] for result in report["runs"][0]["results"]] == ["pass", "fail"]


def test_the_check_finds_what_the_standard_forbids(report):
    first = report["runs"][0]["results"][0]
    for change in ({"level": "error"}, {"kind": "passed"}, {"ruleindex": 0}, {"message": "satisfied"}):
        wrong = json.loads(json.dumps(report))
        wrong["runs"][0]["results"][0] = {**first, **change}
        with pytest.raises(jsonschema.ValidationError):
            check(wrong)
