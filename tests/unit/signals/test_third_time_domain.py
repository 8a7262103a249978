"""A new time domain is one class and one folder: ``tests/unit/signals/third_domain``."""

import pytest

import rtamt
from rtamt.cli import main
from rtamt.signals import time_domains
from tests.unit.signals.third_domain.turns import Turns

TEXT = "always(req >= 3 -> eventually[0:2](gnt >= 3))"
#: The timestamps fit neither another time domain nor the bounds.
DATA = {"time": [0.0, 0.1, 7.0, 7.2, 9.0], "req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 0]}


@pytest.fixture
def listed(monkeypatch):
    """What a new time domain adds to the list in ``signals/time_domains.py``."""
    monkeypatch.setitem(time_domains._LISTED, Turns.name, Turns)


def test_a_third_time_domain_parses_checks_bounds_evaluates_and_explains():
    spec = rtamt.parse(TEXT, time=Turns())
    result = spec.evaluate(DATA)
    assert (result.robustness, result.satisfied, result.trace.domain) == (-2.0, False, Turns())
    assert str(result.explain()).startswith("violated, robustness -2: ")
    assert result.signal.values.tolist() == [-2, -2, 3, 3, 3]
    with pytest.raises(rtamt.BoundError, match=r"0\.5"):
        rtamt.parse("once[0:0.5](req >= 3)", time=Turns())


def test_a_third_time_domain_has_a_monitor():
    monitor = rtamt.parse("req >= 3 -> eventually[0:2](gnt >= 3)", time=Turns()).monitor()
    found = [monitor.update(req=req, gnt=gnt) for req, gnt in zip(DATA["req"], DATA["gnt"], strict=True)]
    assert found == [None, None, 3.0, -2.0, 3.0]


@pytest.mark.usefixtures("listed")
def test_a_third_time_domain_is_a_choice_of_commands(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{t},{r},{g}\n" for t, r, g in zip(*DATA.values(), strict=True))
    (tmp_path / "log.csv").write_text(f"time,req,gnt\n{rows}")
    assert main(["check", TEXT, "log.csv", "--time", "turns", "--json"]) == 1
    assert '"robustness": -2' in capsys.readouterr().out
    assert main(["info", TEXT, "--time", "turns"]) == 0
    with pytest.raises(SystemExit):
        main(["check", "--help"])
    assert "turns: samples are counted" in " ".join(capsys.readouterr().out.split())


def test_what_a_third_time_domain_does_not_have_is_one_sentence():
    spec = rtamt.parse(TEXT, time=Turns())
    with pytest.raises(rtamt.UsageError) as error:
        spec.monitor(verdict="eager")
    assert str(error.value) == "verdict='eager' needs discrete or dense time; use it, or verdict='delayed'"
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.check_stream(spec, [DATA])
    assert str(error.value) == "recordings in turns time are not checked in chunks; evaluate them whole"
