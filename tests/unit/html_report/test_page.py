"""The page of ``rtamt report`` and ``rtamt check --html``: what it holds, and what it says without scripts."""

import base64
import json
import re
import sys
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import rtamt
from rtamt.cli import main
from rtamt.html_report import Formula, Page, Row
from rtamt.html_report.scene_data import data_of
from rtamt.html_report.signals import signals_of
from rtamt.html_report.store import Store
from rtamt.plot.scene import scene

ROWS = "time,req,gnt\n0,0,0\n1,6,0\n2,0,0\n3,0,1\n4,0,7\n"
SPEC = "asked = req >= 3; always(asked -> eventually[0:2](gnt >= 3))"
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'"


class Text(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.text, self.links, self.tags, self.data, self.hidden = "", [], [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.hidden = tag in ("script", "style")
        self.tags.append((tag, dict(attributes)))
        self.links += [value for name, value in attributes if name in ("src", "href") and value]

    def handle_endtag(self, _tag):
        self.hidden = False

    def handle_data(self, data):
        if self.hidden:
            self.data.append((self.tags[-1][1], data))
        else:
            self.text += data


def array(store, number):
    blob = store.blobs[number]
    kind = np.dtype(f"<{blob.kind}")
    weights = np.frombuffer(zlib.decompress(base64.b64decode(blob.text)), np.uint8)
    return np.ascontiguousarray(weights.reshape(kind.itemsize, -1).T).view(kind).ravel()


def test_page_shows_the_episodes_of_violation(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text("time,x\n0,5\n1,2\n2,1\n3,4\n4,0\n5,6\n")
    main(["check", "always(x >= 3)", "a.csv", "--html", "a.html", "--quiet"])
    text = Text(Path("a.html").read_text()).text
    assert "2 episodes of violation, the worst at 4 s: robustness -3" in text
    assert re.search(
        r"sufficient cause[^:]*:\s+'x >= 3' fails", text
    )  # nothing between the head and the causes


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("answer.stl").write_text(SPEC)
    Path("bad & <b>.csv").write_text(ROWS)
    Path("good.csv").write_text(ROWS.replace("6", "2"))
    return ["answer.stl", "good.csv", "bad & <b>.csv"]


@pytest.mark.parametrize("command", [["report", "-o"], ["check", "--quiet", "--html"]])
def test_everything_can_be_read_without_scripts_and_nothing_is_loaded(files, command):
    assert main([command[0], *files, *command[1:], "report.html"]) == 1
    page = Text(Path("report.html").read_text(encoding="utf-8"))
    for sentence in (
        "1 violated, 1 satisfied",
        "violated, robustness -2, first violation at 1 s",
        "first violation at 1 s",
        "critical point at 3 s: 'gnt >= 3' is -2; the robustness follows it from -3 to 3",
        "'req >= 3' holds at 1 s (3)",
        "asked = req >= 3",
        "bad & <b>.csv",
        f"rtamt {rtamt.__version__}",
        f"{len(ROWS)} bytes, modified 20",
    ):
        assert sentence in page.text
    assert all(link.startswith("#") for link in page.links)
    # Violated first, and only its card is open.
    cards = [
        attributes
        for tag, attributes in page.tags
        if tag == "details" and "card" in attributes.get("class", "")
    ]
    assert [card["id"] for card in cards] == ["answer.stl/bad%20%26%20%3Cb%3E.csv", "answer.stl/good.csv"]
    assert ["open" in card for card in cards] == [True, False]
    assert {card["id"] for card in cards} <= {link[1:] for link in page.links}


def test_the_sentences_of_a_card_are_those_of_the_explanation(files):
    main(["report", *files, "-o", "report.html"])
    page = Text(Path("report.html").read_text(encoding="utf-8"))
    for name in files[1:]:
        explanation = rtamt.load("answer.stl").evaluate(rtamt.read(name)).explain()
        for line in str(explanation).splitlines()[1:]:
            assert line.strip() in page.text


def test_hostile_names_and_texts_are_only_text():
    spec = rtamt.parse('require R "<b>": always("</script>" >= 3)')
    result = spec.evaluate(rtamt.read({"</script>": [5, 1]}, units={"</script>": "<b>"}))
    row = Row(HOSTILE, HOSTILE, "violated", "-2", "1 s", "2", notes=(HOSTILE,))
    page = Page(HOSTILE, {HOSTILE: Formula(HOSTILE, HOSTILE)})
    page.add(row, scene(result))
    page.add(Row(HOSTILE, "other", "error", error=HOSTILE))
    text = Text(page.text())
    scripts = [attributes for tag, attributes in text.tags if tag == "script"]
    assert not any(tag == "img" or "onerror" in attributes for tag, attributes in text.tags)
    assert [attributes.get("type") for attributes in scripts if "type" in attributes].count(
        "application/json"
    ) == 1
    assert len([attributes for attributes in scripts if not attributes]) == 2
    (data,) = [
        json.loads(body) for attributes, body in text.data if attributes.get("type") == "application/json"
    ]
    assert data["panels"][0]["lines"][0]["name"] == "</script> [<b>]"
    assert data["trace"] == HOSTILE
    assert text.text.count(HOSTILE) >= 8


def test_a_trace_that_cannot_be_read_is_a_row_of_the_matrix(tmp_path, capsys):
    path = tmp_path / "report.html"
    assert main(["report", "x >= 3", str(tmp_path / "no.csv"), "-o", str(path)]) == 2
    told = capsys.readouterr()
    assert told.err == f"rtamt: there is no file '{tmp_path / 'no.csv'}'\n"
    assert told.out == f"{path}: 1 error\n"
    assert "1 error" in Text(path.read_text()).text


@pytest.mark.usefixtures("files")
def test_a_page_that_cannot_be_written_is_one_sentence(capsys):
    assert main(["report", "req >= 0", "good.csv", "-o", "no/report.html"]) == 2
    assert capsys.readouterr().err == "rtamt: cannot write 'no/report.html': No such file or directory\n"


@pytest.mark.parametrize("command", [["report", "-o"], ["check", "--html"]])
@pytest.mark.usefixtures("files")
def test_without_jinja2_there_is_one_sentence_before_anything_is_read(command, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    assert main([command[0], "answer.stl", "missing.csv", *command[1:], "report.html"]) == 2
    assert capsys.readouterr().err == (
        "rtamt: an HTML report needs the package 'jinja2', which is not installed: pip install 'rtamt[report]'\n"
    )


def test_a_page_holds_every_sample_and_every_interval_exactly():
    rng = np.random.default_rng(5)
    n = 30_000
    x = rng.normal(0, 1, n)
    data = {"time": np.arange(n) * 0.01, "x": x}
    seen = scene(rtamt.parse("always(x <= 4)", period="10ms").evaluate(data))
    store = Store()
    told = data_of(seen, store)
    line = told["panels"][0]["lines"][0]
    assert (array(store, line["y"]["blob"]) == x).all()
    # A comparison is the signal and its threshold; times follow a rule.
    part = told["nodes"][1]["line"]
    assert part["y"] == {"blob": line["y"]["blob"], "sign": -1, "limit": 4.0}
    assert (np.array(4.0 - x) == seen.nodes[1].line.values).all()
    assert (part["x"]["start"] + np.arange(n) * part["x"]["step"] == seen.nodes[1].line.positions).all()
    fails = seen.nodes[1].fails
    stored = told["nodes"][1]["fails"]
    pairs = stored if isinstance(stored, list) else array(store, stored).reshape(-1, 2).tolist()
    assert [tuple(pair) for pair in pairs] == list(fails)
    # What is seen at first holds every peak.
    low, high = (array(store, line["overview"][end]) for end in ("low", "high"))
    assert low.min() <= x.min()
    assert high.max() >= x.max()
    assert len(low) <= 1500
    json.dumps(told, allow_nan=False)


def test_without_room_a_page_holds_ranges_and_no_samples():
    x = np.random.default_rng(5).normal(0, 1, 20_000)
    seen = scene(rtamt.parse("always(x <= 2)").evaluate({"x": x}))
    store = Store(budget=1000)
    line = data_of(seen, store)["panels"][0]["lines"][0]
    assert "y" not in line
    assert {"at", "low", "high"} == set(line["overview"])
    at, low, high = (array(store, line["overview"][name]) for name in ("at", "low", "high"))
    inside = np.searchsorted(at, np.arange(20_000), side="right") - 1
    assert (low[inside] <= x).all()
    assert (x <= high[inside]).all()


def test_equal_arrays_are_stored_once():
    store = Store()
    assert store.put(np.arange(9.0)) == store.put(np.arange(9.0)) == 0
    assert store.put(np.arange(9.0) / 3) == 1
    assert [blob.kind for blob in store.blobs] == ["f4", "f8"]
    assert (array(store, 1) == np.arange(9.0) / 3).all()


def test_infinities_are_text_and_dates_are_milliseconds():
    timestamps = np.datetime64("2026-03-01T12:00") + np.arange(3) * np.timedelta64(1, "s")
    store = Store()
    data = data_of(scene(rtamt.parse("prev(x >= 3)").evaluate({"time": timestamps, "x": [5, 1, 4]})), store)
    assert array(store, data["nodes"][0]["line"]["y"]["blob"]).tolist() == [np.inf, 2, -2]
    assert (data["nodes"][0]["value"], data["nodes"][0]["line"]["ends"]) == ("inf", [False, True])
    assert (data["dated"], data["origin"]) == (True, 1_772_366_400_000.0)


def test_two_hundred_requirements_are_a_small_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("many.stl").write_text(
        "".join(f"require R{i}: always(x <= {i / 4} -> eventually[0:3](x >= {i % 7}));" for i in range(200))
    )
    rows = "".join(f"{i},{np.sin(i / 9) * 20:.3f}\n" for i in range(1000))
    Path("log.csv").write_text(f"time,x\n{rows}")
    assert main(["check", "--quiet", "many.stl", "log.csv", "--html", "many.html"]) == 1
    text = Path("many.html").read_text()
    assert len(re.findall(r'<details class="card', text)) == 200
    assert len(text) < 2_500_000


def test_a_page_holds_what_was_known_after_each_sample():
    store = Store()
    result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2, 6]})
    told = data_of(scene(result, bounds=True), store)["bounds"]
    overview = told["line"]["overview"]
    assert (told["decided"], told["robustness"]) == ("2 s", -1.0)
    assert array(store, overview["at"]).tolist() == [0, 1, 2, 3]
    assert array(store, overview["high"]).tolist() == [2, 1, -1, -1]
    assert array(store, overview["low"]).tolist() == [-np.inf] * 4
    assert told["line"]["ends"] == [True, False]


@pytest.mark.parametrize("more", [[], ["--time", "dense"]])
def test_a_report_shows_bounds_in_both_time_domains(tmp_path, monkeypatch, more):
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text(ROWS)
    assert main(["report", SPEC, "a.csv", "-o", "r.html", *more]) == 1
    assert '"bounds":{"decided":' in Path("r.html").read_text()


def signals(path):
    page = Text(Path(path).read_text(encoding="utf-8"))
    found = [json.loads(text) for tag, text in page.data if tag.get("id", "").startswith("signals-")]
    return page, {each["trace"]: each["lines"] for each in found}


def test_signals_that_no_requirement_reads_are_in_the_page_without_their_nan(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("t [ms],a,speed [m/s],note\n0,5,1,x\n1000,6,nan,y\n2000,7,3,z\n")
    Path("all.csv").write_text("t,a\n0,5\n1,6\n")
    assert main(["report", "v >= 0", "--name", "v=a", "log.csv", "all.csv", "-o", "r.html"]) == 0
    page, lines = signals("r.html")
    assert list(lines) == ["log.csv"]
    (speed,) = lines["log.csv"]
    assert (speed["name"], speed["points"], speed["x"]) == ("speed [m/s]", 2, {"start": 0, "step": 2})
    assert "; 1 other signal can be added to charts" in page.text


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_other_signals_are_on_the_time_axis_of_the_cards(tmp_path, monkeypatch, time):
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text(
        "time,x,y\n" + "".join(f"2026-03-01T12:00:0{i},{i},{i * i}\n" for i in range(5))
    )
    assert main(["check", "--quiet", "x >= 0", "log.csv", "--time", time, "--html", "r.html"]) == 0
    page, lines = signals("r.html")
    (card,) = [json.loads(text) for tag, text in page.data if tag.get("id") == "data-0"]
    assert lines["log.csv"][0]["x"] == card["panels"][0]["lines"][0]["x"] == {"start": 0, "step": 1}


def test_other_signals_that_cannot_be_read_do_not_stop_a_report(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("time,x,y,y\n0,1,2,3\n1,1,2,3\n")
    assert main(["report", "x >= 0", "log.csv", "-o", "r.html"]) == 0
    page, lines = signals("r.html")
    assert lines == {}
    assert "other signals are not in this page: log.csv has 2 columns called 'y'" in page.text


def test_the_room_for_other_signals_is_shared_and_what_has_none_is_named():
    rng = np.random.default_rng(3)
    recording = rtamt.read({f"s{i}": rng.normal(0, 1, 20_000) for i in range(12)} | {"x": np.zeros(20_000)})
    x_axis = scene(rtamt.parse("x >= 0").evaluate(recording)).x_axis
    store = Store()
    others = store.within(2**20)
    found = [signals_of(f"{i}", recording, {"x"}, x_axis, others, (i + 1, 2)) for i in range(2)]
    whole = [[("x" in line) for line in each.lines] for each in found]
    # About 150 KB a signal: two or three of each recording with all samples, then ranges; nothing is stored twice.
    assert whole[0] == sorted(whole[0], reverse=True)
    assert 2 <= sum(whole[0]) <= 3
    assert found[0].ranges > 0
    assert sum(len(blob.text) for blob in store.blobs) < 1.05 * 2**20 * 4 / 3
    assert len(found[0].lines) + len(found[0].left_out) == 12
    assert found[0].left_out == ("s7", "s8", "s9", "s10", "s11") or len(found[0].lines) == 12
