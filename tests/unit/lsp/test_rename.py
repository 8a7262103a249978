"""Other names, as an editor gives them: every kind of name, in every place where it is used."""

import pytest
from pygls.exceptions import JsonRpcException

import rtamt
from tests.unit.lsp.client import Editor, apply_edits

TEXT = """\
specification traffic
import "patterns.stl"
from msgs.msg import Pose

enum Mode { MANUAL, AUTO = 4, "very slow" }
enum Light { OFF, AUTO = 2 }

input Mode mode
optional input Light light = "lamp"
output Pose pose
float "engine temp" [K]
const float most = 30
const Mode usual = AUTO
parameter float least = 2 [m]
parameter Mode wanted = Mode.AUTO
table curve = {(0, 1), (10, 4)}
group cars = "car_*" { float x [m]; float "lane width" [m] = "width"; Mode state }
group trucks = "truck_*"

def near(v, limit = least) = abs(v) <= limit
def slow(v) = always[0:most] (v < curve(most))

fast = "engine temp" > curve(most) and mode == AUTO
require R-1 "text": always(fast -> light == AUTO or mode == "very slow" or pose.x > 1)
require R-2: forall car in cars: near(car.x, limit=least) or car.state == Mode.AUTO
require R-3: forall car in cars: forall other in cars where other != car: car.x > other.x + "car.lane width"
require R-4: exists t in trucks: response(near(t.length), fast) and slow(t.x)
require R-5: always(mode == wanted or mode == usual)
"""

#: What is renamed: the beginning of a line, the name there, the new name, and parts of the lines that change.
RENAMED = [
    (
        "enum Mode",
        "Mode",
        "State",
        [
            "enum State {",
            "input State mode",
            "const State usual",
            "wanted = State.AUTO",
            "; State state }",
            "== State.AUTO",
        ],
    ),
    ("enum Mode", "MANUAL", "HAND", ["enum Mode { HAND, AUTO = 4"]),
    (
        "enum Mode",
        "AUTO",
        "SELF",
        [
            "{ MANUAL, SELF = 4",
            "usual = SELF",
            "wanted = Mode.SELF",
            "and mode == SELF",
            "car.state == Mode.SELF",
        ],
    ),
    ("enum Light", "AUTO", "DUSK", ["enum Light { OFF, DUSK = 2 }", "light == DUSK or mode"]),
    ("enum Mode", '"very slow"', "SLOW", ["4, SLOW }", "mode == SLOW or"]),
    (
        "input Mode",
        "mode",
        "state",
        [
            'input Mode state = "mode"',
            "and state == AUTO",
            'or state == "',
            "(state == wanted or state == usual",
        ],
    ),
    (
        "optional",
        "light",
        "lamp state",
        ['optional input Light "lamp state" = "lamp"', '-> "lamp state" == AUTO'],
    ),
    ('float "engine', '"engine temp"', "temp", ['float temp [K] = "engine temp"', "fast = temp >"]),
    (
        "const float",
        "most",
        "top",
        ["const float top = 30", "always[0:top] (v < curve(top))", "curve(top) and"],
    ),
    ("parameter float", "least", "gap", ["parameter float gap = 2", "limit = gap)", "limit=gap)"]),
    ("parameter Mode", "wanted", "chosen", ["parameter Mode chosen = Mode.AUTO", "mode == chosen"]),
    ("table", "curve", "line", ["table line =", "(v < line(most))", "> line(most)"]),
    (
        "group cars",
        "cars",
        "vehicles",
        ['group vehicles = "car_*"', "car in vehicles: near", "other in vehicles where"],
    ),
    ("group cars", "x", "pos", ['float pos [m] = "x";', "near(car.pos,", "car.pos > other.pos + "]),
    (
        "group cars",
        "x",
        "the pos",
        ['float "the pos" [m] = "x";', 'near("car.the pos",', '"car.the pos" > "other.the pos" + '],
    ),
    ("group cars", '"lane width"', "width", ['float width [m] = "width"', '+ "car.width"\n']),
    ("group trucks", "trucks", "lorries", ['group lorries = "truck_*"', "exists t in lorries:"]),
    ("require R-3", "other", "second", ["forall second in cars where second != car: car.x > second.x"]),
    (
        "require R-3",
        "car",
        "one",
        ["forall one in cars:", 'other != one: one.x > other.x + "one.'],
    ),
    ("def near", "near", "close", ["def close(v,", "close(car.x,", "close(t.length)"]),
    (
        "def near",
        "limit",
        "bound",
        ["def near(v, bound = least) = abs(v) <= bound", "near(car.x, bound=least)"],
    ),
    ("def near", "v", "w", ["def near(w, limit = least) = abs(w) <= limit"]),
    ("fast =", "fast", "quick", ['quick = "engine', "always(quick ->", "near(t.length), quick)"]),
    ("require R-1", "R-1", "REQ-1.a", ['require REQ-1.a "text"']),
    ("require R-1", "R-1", "the first", ['require "the first" "text"']),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("renamed")


@pytest.fixture(scope="module")
def editor(folder):
    made = Editor(folder)
    yield made
    made.stop()


@pytest.fixture(scope="module")
def path(editor, folder):
    made = folder / "traffic.stl"
    assert {each.severity for each in editor.open(made, TEXT)} <= {2, 3}
    return made


def place_of(text, line, name):
    """Return the position of a word in the first line that begins so."""
    number, found = next((k, each) for k, each in enumerate(text.splitlines()) if each.startswith(line))
    at = found.index(name)
    while found[at - 1 : at].isalnum() or found[at + len(name) : at + len(name) + 1].isalnum():
        at = found.index(name, at + 1)
    return number, at


@pytest.mark.parametrize(
    ("line", "name", "new", "changed"), RENAMED, ids=[f"{name}-{new}" for _, name, new, _ in RENAMED]
)
def test_every_use_of_a_name_changes_and_nothing_else(editor, path, line, name, new, changed):
    found = editor.ask("rename", path, *place_of(TEXT, line, name), new_name=new)
    text = apply_edits(TEXT, found.changes[path.as_uri()])
    before = TEXT.splitlines(keepends=True)
    lines = [each for each in text.splitlines(keepends=True) if each not in before]
    assert [words for words in changed if not any(words in each for each in lines)] == []
    assert [each for each in lines if not any(words in each for words in changed)] == []
    assert rtamt.parse(text, folder=path.parent).requirements


TAKEN = "'{}' is a name of this text already; choose another name"
WORD = "the name of {} is one word of letters, digits and '_', got '{}'"
#: A text, the beginning of a line, the name there, the new name, and the answer.
REFUSED = [
    (TEXT, "from msgs", "Pose", "Twist", "'Pose' is a class of messages, whose name is that of its module"),
    (TEXT, "output", "pose", "robot", "'pose' is a message, whose fields are recorded under this name"),
    (TEXT, "require R-4", "response", "answer", "'response' is defined in 'patterns.stl'; rename it there"),
    (TEXT, "require R-1", "always", "G", "there is no name here that can be renamed"),
    (TEXT, "group cars", "cars", "the cars", WORD.format("a group", "the cars")),
    (TEXT, "enum Mode", "Mode", "a.b", WORD.format("an enumeration", "a.b")),
    (TEXT, "enum Mode", "AUTO", "MANUAL", TAKEN.format("MANUAL")),
    (TEXT, "enum Mode", "AUTO", "fast", TAKEN.format("fast")),
    (TEXT, "group cars", "x", "state", TAKEN.format("state")),
    (TEXT, "require R-3", "other", "car", TAKEN.format("car")),
    (TEXT, "def near", "limit", "least", TAKEN.format("least")),
    (
        "always(x > 2)",
        "always",
        "x",
        "y",
        "'x' is not declared, so that it is the name of a recorded signal; declare it, such as float x, to give it "
        "another name",
    ),
    (
        'always("wheel speed" > 2)',
        "always",
        "wheel speed",
        "y",
        "'wheel speed' is not declared, so that it is the name of a recorded signal; declare it, such as "
        'float "wheel speed", to give it another name',
    ),
    (
        "always(x > )",
        "always",
        "x",
        "y",
        "the text has an error; correct it before a name is changed",
    ),
    (
        "float x\nalways(x > )",
        "float",
        "x",
        "y",
        "the text has an error; correct it before a name is changed",
    ),
]


@pytest.mark.parametrize(("text", "line", "name", "new", "sentence"), REFUSED)
def test_a_name_that_cannot_change_is_refused_with_one_sentence(
    editor, folder, text, line, name, new, sentence
):
    path = folder / "refused.stl"
    editor.open(path, text)
    with pytest.raises(JsonRpcException) as error:
        editor.ask("rename", path, *place_of(text, line, name), new_name=new)
    assert error.value.message == sentence


def test_names_that_other_files_use_are_refused(editor, folder):
    path = folder / "shared.stl"
    text = 'enum Mode { A, B }\ngroup cars = "car_*" { float x }\ndef near(v) = v <= 3\n'
    editor.open(path, text)
    (folder / "importer.stl").write_text('import "shared.stl"\nrequire R: forall c in cars: near(v=c.x)\n')
    for line, name in (("enum", "A"), ("group", "x"), ("group", "cars"), ("def", "v")):
        with pytest.raises(JsonRpcException) as error:
            editor.ask("prepare_rename", path, *place_of(text, line, name))
        assert error.value.message == (
            f"'importer.stl' imports this file, where '{name}' may be used; rename it in both by hand"
        )
    editor.open(folder / "importer.stl", 'import "shared.stl"\nMode m;\nrequire R: always(m == B)\n')
    with pytest.raises(JsonRpcException) as error:
        editor.ask("rename", folder / "importer.stl", 2, 23, new_name="C")
    assert error.value.message == "'B' is defined in 'shared.stl'; rename it there"
