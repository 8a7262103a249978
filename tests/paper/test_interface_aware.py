"""The paper's Fig. 4: four behaviours of request and grant under interface-aware semantics, in all modes and faces."""

from __future__ import annotations

from math import inf
from typing import Any

import pytest

import rtamt
from rtamt.compat import interface_aware

FOLDER = "examples/request_grant"

# As printed under the figure; what it leaves out follows from the definition.
FIG4 = {
    "a_satisfied": {"standard": 3, "output_robustness": 3, "input_vacuity": 0, "boolean": inf},
    "b_vacuous": {"standard": 1, "output_robustness": inf, "input_vacuity": 1, "boolean": inf},
    "c_violated": {"standard": -2, "output_robustness": -2, "input_vacuity": 0, "boolean": -inf},
    "d_weak_request": {"standard": -1, "output_robustness": -2, "input_vacuity": 0, "boolean": -inf},
}
CASES = [(name, semantics) for name, values in FIG4.items() for semantics in values]
BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])


@BACKENDS
@pytest.mark.parametrize(("name", "semantics"), CASES)
def test_fig_4_in_all_four_modes(name: str, semantics: str, backend: str) -> None:
    spec = rtamt.load(f"{FOLDER}/spec.stl", semantics=semantics, backend=backend)
    data = rtamt.read(f"{FOLDER}/{name}.csv", columns=spec.input_names)
    expected = FIG4[name][semantics]
    assert spec.evaluate(data).robustness == expected
    assert spec.evaluate(data, time="dense").robustness == expected
    assert spec.evaluate(data).satisfied is (FIG4[name]["boolean"] > 0)

    # Online, where unbounded future has no value: up to the end of the recording, which is at 20 s.
    bounded = spec.text.replace("always(", "always[0:20](")
    watched = rtamt.parse(bounded, semantics=semantics, backend=backend)
    for monitor in (watched.monitor(), watched.monitor(time="dense")):
        signals = (monitor.update_many(data), monitor.finish())
        assert next(value for signal in signals for value in signal.values) == expected


def declared(cls: Any, semantics: rtamt.Semantics | None = None) -> Any:
    spec = cls() if semantics is None else cls(semantics=semantics)
    spec.declare_var("req", "float")
    spec.declare_var("gnt", "float")
    spec.set_var_io_type("req", "input")
    spec.set_var_io_type("gnt", "output")
    spec.spec = "always[0:20]((req >= 3) -> (eventually[0:5](gnt >= 3)))"
    spec.parse()
    return spec


def ways(semantics: rtamt.Semantics, time: str, mode: str) -> list[Any]:
    """Return the specifications of the paper's API that have a semantics in a mode."""
    combined = getattr(rtamt, f"Stl{time}TimeSpecification")
    found = [declared(combined, semantics)]
    if time == "Discrete":
        found.append(declared(rtamt.StlDiscreteTimeSpecificationCpp, semantics))
    if semantics is rtamt.Semantics.STANDARD:
        found.append(declared(getattr(rtamt, f"Stl{time}Time{mode}Specification")))
    else:
        word = "".join(part.capitalize() for part in semantics.value.split("-"))
        found.append(declared(getattr(rtamt, f"IAStl{word}{time}Time{mode}Specification")))
    return found


@pytest.mark.parametrize(("name", "semantics"), [case for case in CASES if case[1] != "boolean"])
def test_fig_4_through_the_papers_api(name: str, semantics: str) -> None:
    chosen = rtamt.Semantics[semantics.upper()]
    trace = rtamt.read(f"{FOLDER}/{name}.csv", columns=("req", "gnt"))
    data = {k: column.tolist() for k, column in trace.on_one_time_base(("req", "gnt")).items()}
    expected = FIG4[name][semantics]
    pairs = [[k, list(map(list, zip(data["time"], data[k], strict=True)))] for k in ("req", "gnt")]
    for spec in ways(chosen, "Discrete", "Offline"):
        assert spec.evaluate(data)[0] == [0, expected]
    for spec in ways(chosen, "Dense", "Offline"):
        assert spec.evaluate(*pairs)[0] == [0, expected]

    # Online the pastified formula speaks of the instant one horizon (25 s) ago, so the last values are held so long.
    rows = [*zip(data["time"], data["req"], data["gnt"], strict=True)]
    for spec in ways(chosen, "Discrete", "Online"):
        spec.pastify()
        held = [(float(t), *rows[min(t, len(rows) - 1)][1:]) for t in range(26)]
        got = [spec.update(t, [("req", req), ("gnt", gnt)]) for t, req, gnt in held]
        assert got[25] == expected
    for spec in ways(chosen, "Dense", "Online"):
        spec.pastify()
        known = spec.update(*([k, [*points, [30.0, points[-1][1]]]] for k, points in pairs))
        assert [value for time, value in known if time <= 25][-1] == expected


def test_every_class_has_the_semantics_of_its_name_and_can_be_imported_from_its_old_place() -> None:
    from rtamt.spec.iastl.dense_time import specification as dense
    from rtamt.spec.iastl.discrete_time import specification as discrete

    names = []
    for semantics in list(rtamt.Semantics)[1:]:
        word = "".join(part.capitalize() for part in semantics.value.split("-"))
        for time, module in (("Discrete", discrete), ("Dense", dense)):
            for mode in ("Offline", "Online"):
                name = f"IAStl{word}{time}Time{mode}Specification"
                cls = getattr(rtamt, name)
                assert getattr(module, name) is cls
                assert cls.__name__ == name
                assert cls.__doc__.startswith(f"{word[:5]}")
                assert cls().semantics is semantics
                assert isinstance(cls(), getattr(rtamt, f"Stl{time}Time{mode}Specification"))
                names.append(name)
    assert sorted(names) == sorted(name for name in dir(interface_aware) if name.startswith("IAStl"))
