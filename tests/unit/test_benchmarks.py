"""What the figures rest on: signals whose verdicts are known, and a run of `make bench` in small."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import start_up
import summary
import timescales
from cases import Case

import rtamt

FOLDER = Path(__file__).parents[2] / "benchmarks"
PEERS = FOLDER.parent / "conformance" / "peers"


@pytest.mark.parametrize("unit", [1, 7])
@pytest.mark.parametrize("family", timescales.FAMILIES)
def test_every_verdict_of_a_timescales_trace_is_the_one_it_was_made_for(family, unit):
    n = 700
    for wrong in (False, True):
        data = timescales.signals(family, unit, n, wrong=wrong)
        past = rtamt.parse(timescales.formula(family, unit, "past"), backend="python")
        values = past.evaluate({name: data[name] for name in past.input_names}).signal.values
        first = timescales.violated_at(family, unit, n) if wrong else n
        np.testing.assert_array_equal(values < 0, np.arange(n) >= first)
        future = rtamt.parse(timescales.formula(family, unit, "future"))
        assert future.evaluate({name: data[name] for name in future.input_names}).satisfied is not wrong


def test_a_quick_run_measures_all_and_writes_report_and_plots(tmp_path):
    command = [sys.executable, str(FOLDER / "run.py"), "--quick", "--alone", "--out", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    report = (tmp_path / "RESULTS.md").read_text(encoding="utf-8")
    for heading in (
        "Summary",
        "How this was measured",
        "Paper: offline, dense time",
        "Online, discrete time",
        "Timescales: past form",
        "Start-up",
    ):
        assert f"\n## {heading}" in report
    for plot in tmp_path.joinpath("plots").iterdir():
        assert plot.read_bytes().startswith(b"\x89PNG")
        assert f"plots/{plot.name}" in report
    assert len(list(tmp_path.joinpath("plots").iterdir())) == 7


def test_the_summary_names_every_row_that_falls_short_and_where():
    case = Case("online, dense time", "always[0:{k}](a >= -2)", 10, "", "dense", "online", {})
    text = summary.write(
        {(case, "mstlo"): 3.2, (replace(case, x=1000), "mstlo"): 7.0, (case, "this (step)"): 0.5},
        {"this": start_up.Start([0.01], [0.05]), "Reelay": start_up.Start([0.02], [0.02])},
        [{"formula": "a", "samples": 10_000, "ratio": 1.5}],
    )
    assert "| online, an update: a peer takes at least 5× | 2 | 1 | 1 | 5.1× |" in text
    assert "| both: no peer is faster | 2 | 2 | 0 | 5.1× |" in text
    assert (
        "| offline: at most 1.5× the time of a hand-written loop, from 10⁴ samples on | 1 | 1 | 0 | 1.5× |"
        in text
    )
    assert "- online, dense time, `always[0:{k}](a >= -2)`, mstlo: 3.2× at 10\n" in text
    assert "| start-up, import: no peer is faster | 1 | 1 | 0 | 2× |" in text
    assert "- first verdict, Reelay: 0.4×\n" in text
    assert text.count("\n- ") == 2


def test_a_tool_that_is_asked_how_long_it_takes_answers_in_seconds_a_sample():
    question = {
        "formula": {"op": "ge", "args": [{"var": "a"}, {"const": 0.0}]},
        "time": "discrete",
        "mode": "online",
        "workload": {"kind": "normal", "names": ["a"], "n": 300, "warm": 10, "limit": 0.1, "patience": 5},
    }
    command = [sys.executable, str(PEERS / "ask_this.py")]
    said = subprocess.run(
        command, input=json.dumps(question) + "\n", check=True, capture_output=True, text=True, timeout=60
    )
    _, answer = map(json.loads, said.stdout.splitlines())
    assert 0 < answer["seconds"] < 1


def test_the_reader_of_a_tool_is_timed_without_the_adapter(monkeypatch):
    import timing

    now = iter(range(1000))
    monkeypatch.setattr(timing, "process_time", lambda: next(now))
    done = []

    def reading(formula, time, mode, names):
        done.append(("written", formula, time, mode, names))
        return lambda: done.append("read")

    answer = timing.measure(None, reading, {"var": "a"}, "dense", "online", {"kind": "parse"})
    assert done == [("written", {"var": "a"}, "dense", "online", ["a"])] + ["read"] * 5
    assert answer == {"seconds": 1}


def test_every_program_that_is_started_prints_the_verdict_and_is_counted_but_for_its_first_process():
    starts = start_up.measure({"this": sys.executable}, 2)
    assert list(starts) == [start_up.ALONE, "this"]
    for start in starts.values():
        assert len(start.processor) == len(start.whole) == len(start.elapsed) == 2
        assert all(0 < early < late for early, late in zip(start.imported, start.processor, strict=True))
        assert all(seconds > 0 for seconds in (*start.whole, *start.elapsed))


def test_start_up_is_compared_process_by_process():
    starts = {
        start_up.ALONE: start_up.Start([0.01, 0.01, 0.01], [0.01, 0.01, 0.01], [0.01] * 3, [0.02] * 3),
        "this": start_up.Start([0.01, 0.02, 0.01], [0.02, 0.04, 0.05], [0.05] * 3, [0.06] * 3),
        "Reelay": start_up.Start(
            [0.02, 0.02, 0.03], [0.04, 0.04, 0.01], [0.05, 0.05, 0.06], [0.06, 0.07, 0.07]
        ),
    }
    assert start_up.ratios(starts, start_up.TO_IMPORT) == {"Reelay": 2.0}
    assert start_up.ratios(starts, start_up.TO_VERDICT) == {"Reelay": 1.0}
    assert "| Reelay | 20.0 ms | 10.0 ms | 40.0 ms | 30.0 ms | 50.0 ms | 70.0 ms |" in start_up.section(
        starts
    )
