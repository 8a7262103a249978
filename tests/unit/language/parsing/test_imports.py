"""``import "patterns.stl"``: what is imported, where from, and what never is."""

import os
import pickle
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
import pytest

import rtamt
from rtamt.errors import StlError
from rtamt.language.formula import Span, postorder
from rtamt.language.operators import STL
from rtamt.language.parsing import import_parser, imports
from rtamt.language.parsing.parser import parse_formula

LIBRARY = """\
import "limits.stl"
const float target = 10
parameter float band = 0.5
near = speed <= limit
def far(x) = x > limit and not near
def settles(x, within = 5s) = eventually[0:within] always(abs(x - target) <= band)
require Q: speed > 3
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "patterns.stl").write_text(LIBRARY)
    (tmp_path / "lib" / "limits.stl").write_text("const float limit = 7")
    return tmp_path


def loaded(folder, text, **settings):
    (folder / "main.stl").write_text(text)
    return rtamt.load(folder / "main.stl", **settings)


MAIN = """\
import "lib/patterns.stl"
input float speed
require R: near and settles(speed)
require S: far(speed) or speed == target
"""


def test_everything_but_requirements_is_imported(folder):
    spec = loaded(folder, MAIN)
    assert {name: str(one.formula) for name, one in spec.requirements.items()} == {
        "R": "speed <= 7 and eventually[0:5s](always(abs(speed - 10) <= 0.5))",
        "S": "speed > 7 and not(speed <= 7) or speed == 10",
    }
    assert dict(spec.parameters) == {"band": 0.5}
    assert rtamt.parse(MAIN, folder=folder).formula == spec.formula


def test_a_specification_needs_its_files_only_once(folder):
    spec = loaded(folder, MAIN)
    (folder / "lib" / "patterns.stl").unlink()
    again = pickle.loads(pickle.dumps(spec))
    assert again.formula == spec.formula
    assert str(again.with_parameters(band=2.0).requirements["R"].formula).endswith("<= 2))")


def test_positions_in_an_imported_file_are_not_positions_in_the_text_that_imports_it(folder):
    spec = loaded(folder, MAIN)
    end = len(spec.text)
    for node in postorder(spec.formula):
        assert node.span is None or node.span.end <= end
    (used,) = [node for node in postorder(spec.formula) if str(node) == "abs(speed - 10)"]
    assert spec.text[used.span.start : used.span.end] == "settles(speed)"
    (defined, *_) = [node for node in postorder(spec.formula) if str(node) == "speed <= 7"]
    assert defined.span == Span(0, len('import "lib/patterns.stl"'))


def test_one_file_imported_on_two_ways_is_no_conflict(folder):
    (folder / "lib" / "more.stl").write_text('import "limits.stl" wide = speed <= 2 * limit')
    spec = loaded(folder, 'import "lib/patterns.stl" import "lib/more.stl" near and wide')
    assert spec.formula == parse_formula("speed <= 7 and speed <= 2 * 7")


def test_a_declared_name_and_a_formula_may_be_called_import(folder):
    assert loaded(folder, "import > 3").formula == parse_formula('"import" > 3')
    assert str(loaded(folder, 'from m import import  import "my var"; "my var" > 3').formula)


def test_the_package_has_templates():
    spec = rtamt.parse(
        'import "signals.stl" require R: settles(v, 10, band=1, within=2s) and stays(v, 0, 12)'
    )
    assert spec.evaluate({"v": [0, 5, 10, 10.5]}).satisfied
    both = 'import "signals.stl" import "patterns.stl" '
    other = rtamt.parse(both + "tracks(v, 10, 1, 2) and response_within(a > 0, b > 0, 1)")
    assert not other.evaluate({"v": [0, 5, 9, 10], "a": [0, 1, 0, 0], "b": [0, 0, 0, 1]}).satisfied


def test_what_an_imported_formula_reads_must_be_declared(folder):
    with pytest.raises(rtamt.NameInFormulaError) as caught:
        loaded(folder, 'import "lib/patterns.stl" input float v; require R: near and v > 3')
    assert caught.value.message == "'speed', which an imported formula reads, is not declared"


CONTENTS = "root:x:0:0:secret"


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("../main.stl", "the path of an import is relative"),
        ("lib/../lib/limits.stl", "the path of an import is relative"),
        ("C:x.stl", "the path of an import is relative"),
        ("lib\\limits.stl", "the path of an import is relative"),
        ("/etc/passwd", "the path of an import is relative"),
        ("passwd", "only specification files are imported: their names end in .stl"),
        ("", "only specification files are imported: their names end in .stl"),
        ("lib", "only specification files are imported: their names end in .stl"),
        ("link.stl", "'link.stl' is a link to another place; only files in the folder itself are imported"),
        ("away/x.stl", "'away/x.stl' is a link to another place; only files in the folder itself are imported"),
        ("inner.stl", "'inner.stl' is a link to another place; only files in the folder itself are imported"),
        ("pipe.stl", "'pipe.stl' is not a regular file"),
        ("dir.stl", "'dir.stl' is not a regular file"),
        ("bytes.stl", "'bytes.stl' is not UTF-8 text (byte 0)"),
        ("lib/pattern.stl", "there is no file 'lib/pattern.stl' in the folder of this file, nor in the package; "
         "did you mean 'patterns.stl'?"),
        ("signal.stl", "there is no file 'signal.stl' in the folder of this file, nor in the package; "
         "did you mean 'signals.stl'?"),
        ("one.stl", "two.stl, line 1, column 8: files cannot import each other, but one.stl -> two.stl -> one.stl"),
    ],
)  # fmt: skip
def test_what_cannot_be_imported(folder, tmp_path_factory, path, message):
    away = tmp_path_factory.mktemp("away")
    for name in ("passwd", "x.stl"):
        (away / name).write_text(CONTENTS)
    (folder / "passwd").write_text(CONTENTS)
    (folder / "link.stl").symlink_to(away / "passwd")
    (folder / "inner.stl").symlink_to(folder / "passwd")  # not a specification file
    (folder / "away").symlink_to(away)
    (folder / "dir.stl").mkdir()
    (folder / "bytes.stl").write_bytes(b"\xff\xfe")
    (folder / "one.stl").write_text('import "two.stl"')
    (folder / "two.stl").write_text('import "one.stl"')
    os.mkfifo(folder / "pipe.stl")
    with pytest.raises(rtamt.SpecificationError) as caught:
        loaded(folder, f'import "{path}" speed > 3')
    assert caught.value.message.startswith(message)
    assert "secret" not in str(caught.value)


def test_a_text_imports_only_from_the_package():
    packaged = ", ".join(sorted(name for name in os.listdir(imports.PACKAGED) if name.endswith(".stl")))
    with pytest.raises(rtamt.ParseError) as caught:
        rtamt.parse('import "lib/patterns.stl" near')
    assert caught.value.message == (
        f"there is no file 'lib/patterns.stl' in the package ({packaged}), and a text has no folder of its own: to "
        "import from a folder, load a file with rtamt.load, or name the folder: rtamt.parse(text, folder=...)"
    )
    with pytest.raises(rtamt.UsageError, match="folder is 3, expected text or a Path"):
        rtamt.parse("x > 3", folder=3)


MESSAGES = [
    ('import "lib/patterns.stl" const int limit = 3; near',
     "'limit' is declared twice (it is imported from 'limits.stl')"),
    ('import "lib/patterns.stl" near = v > 3', "'near' is defined twice (it is imported from 'patterns.stl')"),
    ('import "lib/patterns.stl" import "other.stl" near',
     "'target' is in 'patterns.stl' and in 'other.stl'; rename one of them"),
    ('import "wrong.stl" near', "wrong.stl has an error in line 1, column 11: 'rtamt lint wrong.stl' shows it"),
    ('input float x import "lib/limits.stl" x > 3', "imports stand at the beginning, before declarations"),
    ('import "lib/limits.stl"', "the text has declarations but no formula"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), MESSAGES)
def test_messages(folder, text, message):
    (folder / "other.stl").write_text("const int target = 10")
    (folder / "wrong.stl").write_text("near = x >")
    with pytest.raises(rtamt.SpecificationError) as caught:
        loaded(folder, text)
    assert caught.value.message == message


WRONG = [
    ("near = x >", 11, rtamt.ParseError),
    ("SECRET root:x:0", 8, rtamt.ParseError),
    ("far = x > 3 # secret", 13, rtamt.ParseError),
    ("const float secret = 3 [m]; near = always[0:secret](x > 3)", 45, rtamt.BoundError),
]


@pytest.mark.parametrize("through", [False, True])
@pytest.mark.parametrize(("line", "column", "kind"), WRONG)
def test_errors_in_imported_files_show_the_import_and_no_word_of_the_file(
    folder, line, column, kind, through
):
    (folder / "wrong.stl").write_text(f"const float c = 3\n{line}")
    (folder / "through.stl").write_text('import "wrong.stl"  const float hidden = 3')
    path = "through.stl" if through else "wrong.stl"
    with pytest.raises(kind) as caught:
        loaded(folder, f'\nimport "{path}" near')
    assert caught.value.message == (
        f"wrong.stl has an error in line 2, column {column}: 'rtamt lint wrong.stl' shows it"
    )
    marks = " " * 7 + "^" * (len(path) + 2)
    assert (
        str(caught.value)
        == f'{caught.value.message}\n  line 2, column 8:\n    import "{path}" near\n    {marks}'
    )


def test_files_are_limited(folder, monkeypatch):
    monkeypatch.setattr(imports, "MOST_BYTES", 20)
    with pytest.raises(rtamt.ParseError, match=r"'lib/patterns\.stl' is too long"):
        loaded(folder, 'import "lib/patterns.stl" near')
    monkeypatch.setattr(imports, "MOST_BYTES", 2**20)
    monkeypatch.setattr(imports, "MOST_FILES", 1)
    with pytest.raises(rtamt.ParseError, match=r"'limits\.stl' is one file too many"):
        loaded(folder, 'import "lib/patterns.stl" near')
    for i in range(30):
        (folder / f"n{i}.stl").write_text(f'import "n{i + 1}.stl"')
    monkeypatch.setattr(imports, "MOST_FILES", 100)
    with pytest.raises(rtamt.ParseError, match="at most 20 files may import one another"):
        loaded(folder, 'import "n0.stl" x > 3')


def test_a_boolean_argument_of_an_imported_template_is_its_truth(tmp_path):
    (tmp_path / "own.stl").write_text("def seen(p) = once(p)")
    (tmp_path / "spec.stl").write_text('import "own.stl" bool b; seen(b)')
    here = rtamt.parse("bool b; def seen(p) = once(p); seen(b)")
    imported = rtamt.load(tmp_path / "spec.stl")
    assert imported.formula == here.formula
    assert imported.evaluate({"b": [False, True]}).signal.values.tolist() == [-np.inf, np.inf]


def test_a_file_that_imports_no_other_is_parsed_once_for_all_texts(folder, monkeypatch):
    parsed, original = [], import_parser._parse_file.__wrapped__

    def parse(key):
        parsed.append(key)
        return original(key)

    monkeypatch.setattr(import_parser, "_placed", lru_cache(import_parser._placed.__wrapped__))
    monkeypatch.setattr(import_parser, "_parse_file", lru_cache(parse))
    (folder / "own.stl").write_text("const float most = 3  slow = x <= most; def low(y) = y <= most and slow")
    own = 'import "own.stl"; input float x; low(x)'
    for _ in range(2):
        assert str(rtamt.parse(own, folder=folder)) == "x <= 3 and x <= 3"
        assert str(rtamt.parse(f"// Another place.\n{own}", folder=folder)) == "x <= 3 and x <= 3"
    assert len(parsed) == 1
    (folder / "own.stl").write_text("const float most = 4  slow = x <= most; def low(y) = y <= most and slow")
    assert str(rtamt.parse(own, folder=folder)) == "x <= 4 and x <= 4"
    assert len(parsed) == 2


def test_what_is_kept_of_an_imported_file_has_the_meaning_of_each_text_that_imports_it(folder):
    (folder / "own.stl").write_text("input bool on  const float d = 2  soon = eventually[0:d](on)")
    own = 'import "own.stl"; soon'
    ends = [rtamt.parse(own, folder=folder, unit=unit).formula.interval.end for unit in ("s", "ms", "s")]
    assert ends == [2, Fraction(1, 500), 2]
    first, moved = (rtamt.parse(text, folder=folder).formula.span for text in (own, f"   {own}"))
    assert (first, moved) == (Span(0, 16), Span(3, 19))
    (folder / "own.stl").write_text("parameter float d = 2  soon = eventually[0:d](x > 3)")
    spec = rtamt.parse(own, folder=folder)
    ends = [each.formula.interval.end for each in (spec, spec.with_parameters(d=5), spec)]
    assert ends == [2, 5, 2]


def test_an_imported_file_has_the_operators_of_the_text_that_imports_it(folder):
    near = replace(STL["gt"], name="near", spellings=("~~",), definition=lambda a, b: a - b, truth=None)
    (folder / "own.stl").write_text("same = x ~~ y")
    own = 'import "own.stl"; same'
    assert str(rtamt.parse(own, folder=folder, language=STL.extend(near))) == "x ~~ y"
    with pytest.raises(StlError, match=r"own.stl has an error in line 1, column 10"):
        rtamt.parse(own, folder=folder)
