"""The language server as an editor sees it: pygls' own client, over the standard streams of a process."""

import asyncio

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from tests.unit.lsp.client import Editor, apply_edits

TEXT = """\
specification drive
import "patterns.stl"

input float speed [m/s]  // of the vehicle
output float brake
const float most = 30 [m/s]

def calm(x, limit = 1) = abs(x) <= limit
fast = speed > most

require R1 "brakes when fast": always(fast -> eventually[0:2](brake >= 0.5))
require R2: always(calm(speed, limit=50))
"""
LOG = "time,speed,brake,engine temp\n0,10,0,1\n1,40,0,1\n2,40,1,1\n3,10,0,1\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("work")
    (made / "drive.csv").write_text(LOG)
    return made


@pytest.fixture(scope="module")
def editor(folder):
    made = Editor(folder, {"recording": "drive.csv", "documentation": "https://example.org/rtamt/"})
    yield made
    made.stop()


@pytest.fixture(scope="module")
def path(editor, folder):
    made = folder / "drive.stl"
    assert editor.open(made, TEXT) == []
    return made


def line_of(words):
    return next(number for number, line in enumerate(TEXT.splitlines()) if words in line)


def span_of(found):
    return (found.start.line, found.start.character, found.end.line, found.end.character)


def test_an_error_has_its_range_and_goes_when_it_is_corrected(editor, folder):
    path = folder / "wrong.stl"
    (error,) = editor.open(path, "float x\nalways(x >= )\n")
    assert span_of(error.range) == (1, 12, 1, 13)
    assert (error.severity, error.code, error.source) == (lsp.DiagnosticSeverity.Error, None, "rtamt")
    assert error.message == "expected an operand after '>=', got ')'"
    assert editor.change(path, "float x\nalways(x >= 3)\n") == []


def test_every_error_is_shown_once(editor, folder):
    text = "float x\nfloat y [m\nlow = x < \nrequire A: always(low and y > z)\nrequire B: once(x > 1 adn y > 2)\n"
    found = editor.open(folder / "errors.stl", text)
    assert [(span_of(each.range)[:2], each.message) for each in found] == [
        ((1, 8), "expected a unit and ']' after 'y [', such as [m/s]"),
        ((3, 0), "expected an operand after '<', got 'require'"),
        ((3, 30), "'z' is not declared; declared names: low, x, y"),
        ((4, 22), "expected an operator between '1' and 'adn'; did you mean 'and'?"),
    ]
    corrected = text.replace("[m", "[m]").replace("x < ", "x < 2").replace("z", "0").replace("adn", "and")
    assert editor.change(folder / "errors.stl", corrected) == []


def test_positions_are_counted_in_utf_16(editor, folder):
    (error,) = editor.open(folder / "wide.stl", '"\U0001f600" > 3 and and\r\n')
    assert span_of(error.range)[:2] == (0, 13)


def test_a_finding_has_a_code_a_link_and_fixes(editor, folder):
    path, text = folder / "finding.stl", "always(not not (x > 3))\n"
    (found,) = editor.open(path, text)
    assert (found.code, found.severity) == ("RT503", lsp.DiagnosticSeverity.Warning)
    assert found.code_description.href == "https://example.org/rtamt/reference/warnings/RT503/"
    actions = editor.ask("code_action", path, range=found.range, context=lsp.CodeActionContext([found]))
    titles = [each.title for each in actions]
    assert titles == [
        "Fix RT503: a double negation",
        "Ignore RT503 on this line",
        "Fix all findings that have a fix",
    ]
    texts = [apply_edits(text, each.edit.changes[path.as_uri()]) for each in actions]
    assert texts == [
        "always((x > 3))\n",
        "always(not not (x > 3)) // lint: ignore[RT503]\n",
        "always((x > 3))\n",
    ]
    assert [editor.change(path, new) for new in texts] == [[], [], []]


def test_hover_describes_names_and_operators(editor, path):
    shown = editor.ask("hover", path, line_of("fast ="), 1)
    assert span_of(shown.range) == (8, 0, 8, 4)
    assert shown.contents.value == (
        "```stl\nfast = speed > most\n```\n\nspeed is more than most (30 m/s).\n\n"
        "Horizon 0 s; a monitor takes 16 bytes."
    )
    shown = editor.ask("hover", path, line_of("R1"), 48).contents.value
    assert "`eventually`" in shown
    assert "prefix operator, future, interval optional" in shown
    shown = editor.ask("hover", path, line_of("fast ="), 8).contents.value
    assert shown == ("```stl\ninput float speed [m/s]\n```\n\nof the vehicle\n\nInput variable; unit m/s.")


def test_completion_has_names_words_patterns_and_columns(editor, path):
    items = {each.label: each for each in editor.ask("completion", path, line_of("fast ="), 8).items}
    assert items["most"].kind == lsp.CompletionItemKind.Constant
    assert items["calm"].detail == "template"
    assert items["eventually"].documentation.value.startswith("At some instant")
    assert items["response_within"].detail == "response_within(p, s, duration)"
    column = items["engine temp"]
    assert (column.text_edit.new_text, column.detail) == ('"engine temp"', "a column of the recording")
    added = apply_edits(TEXT, column.additional_text_edits)
    assert 'output float brake\nfloat "engine temp"\nconst float most' in added
    likeliest = ["speed", "engine temp", "response_within", "always", "enum"]
    assert sorted(likeliest, key=lambda label: items[label].sort_text) == likeliest


@pytest.mark.parametrize(
    ("text", "new"),
    [
        ("float x  // m\nalways(en", 'float x  // m\nfloat "engine temp"\nalways(en'),
        ("float x; always(en", 'float x; float "engine temp"; always(en'),
        ("float x always(en", 'float x float "engine temp"; always(en'),
    ],
)
def test_a_column_is_declared_behind_the_variables(editor, folder, text, new):
    path = folder / "columns.stl"
    editor.open(path, text)
    line = text.count("\n")
    items = editor.ask("completion", path, line, len(text.splitlines()[-1])).items
    (column,) = (each for each in items if each.label == "engine temp")
    assert apply_edits(text, column.additional_text_edits) == new
    assert column.filter_text == "engine temp"
    editor.change(path, text.replace("(en", '("en'))
    items = editor.ask("completion", path, line, len(text.splitlines()[-1]) + 1).items
    assert '"engine temp"' in [each.filter_text for each in items]


def test_definition_and_references(editor, path, folder):
    found = editor.ask("definition", path, line_of("fast ="), 15)
    assert (found.uri, span_of(found.range)) == (path.as_uri(), (5, 12, 5, 16))
    places = editor.ask(
        "references", path, line_of("input"), 13, context=lsp.ReferenceContext(include_declaration=True)
    )
    assert [span_of(each.range)[0] for each in places] == [3, 8, 11]
    other = folder / "uses.stl"
    editor.open(other, 'import "patterns.stl"\nalways(response(p, s))\n')
    elsewhere = editor.ask("definition", other, 1, 9)
    assert elsewhere.uri.endswith("/rtamt/library/patterns.stl")


def test_rename_keeps_the_meaning_and_refuses_clashes(editor, path):
    line = line_of("fast =")
    edit = editor.ask("rename", path, line, 8, new_name="v")
    new = apply_edits(TEXT, edit.changes[path.as_uri()])
    assert 'input float v [m/s] = "speed"  // of the vehicle' in new
    assert "fast = v > most" in new
    assert "calm(v, limit=50)" in new
    edit = editor.ask("rename", path, line_of("def"), 12, new_name="bound")
    new = apply_edits(TEXT, edit.changes[path.as_uri()])
    assert "def calm(x, bound = 1) = abs(x) <= bound" in new
    assert "calm(speed, bound=50)" in new
    for name, sentence in (
        ("most", "'most' is a name of this text already; choose another name"),
        ("always", "'always' is a word of the language; choose another name"),
        ("", "a name is one line of visible characters"),
    ):
        with pytest.raises(JsonRpcException) as error:
            editor.ask("rename", path, line, 8, new_name=name)
        assert error.value.message == sentence
    assert span_of(editor.ask("prepare_rename", path, line_of("R1"), 9)) == (10, 8, 10, 10)


def test_semantic_tokens_and_symbols(editor, path):
    legend = editor.capabilities.semantic_tokens_provider.legend
    data = editor.ask("semantic_tokens_full", path).data
    line = character = 0
    found = []
    for at in range(0, len(data), 5):
        down, right, width, kind, _ = data[at : at + 5]
        line, character = line + down, right + (0 if down else character)
        found.append((TEXT.splitlines()[line][character : character + width], legend.token_types[kind]))
    assert ("speed", "variable") in found
    assert ("m", "type") in found
    assert ("calm", "function") in found
    assert ("eventually", "keyword") in found
    assert ("// of the vehicle", "comment") in found
    names = [each.name for each in editor.ask("document_symbol", path)]
    assert names == ["speed", "brake", "most", "calm", "fast", "R1", "R2"]


def test_lenses_show_verdicts_on_the_recording(editor, path):
    result = editor.run(
        editor.client.workspace_execute_command_async(
            lsp.ExecuteCommandParams("rtamt.check", [path.as_uri()])
        )
    )
    assert [row["verdict"] for row in result["rows"]] == ["satisfied", "satisfied"]
    titles = [each.command.title for each in editor.ask("code_lens", path)]
    assert titles == ["✓ satisfied, robustness 0.5 (drive.csv)", "✓ satisfied, robustness 10 (drive.csv)"]
    editor.change(path, TEXT.replace("0.5))", "2))"))
    assert editor.ask("code_lens", path)[0].command.title == "check against drive.csv"
    editor.change(path, TEXT)
    assert editor.ask("code_lens", path)[0].command.title == titles[0]
    assert editor.refreshed > 0


def test_a_verdict_is_that_of_the_text_and_of_the_recording_that_were_checked(editor, folder):
    path, text = folder / "busy.stl", "require R: always(speed < 50)\n"

    def check():
        params = lsp.ExecuteCommandParams("rtamt.check", [path.as_uri()])
        return asyncio.ensure_future(editor.client.workspace_execute_command_async(params), loop=editor.loop)

    def lens():
        return editor.ask("code_lens", path)[0].command.title

    editor.open(path, text)
    first = check()
    lens()  # once there is an answer, the check has begun
    editor.change(path, "require R: always(speed < 20)\n")
    assert lens() == "check against drive.csv"
    second = check()
    assert editor.run(first)["rows"][0]["verdict"] == "satisfied"
    assert editor.run(second)["rows"][0]["verdict"] == "violated"
    assert lens() == "✗ violated, robustness -20 (drive.csv)"
    (folder / "drive.csv").write_text(LOG.replace("40", "10"))
    assert lens() == "check against drive.csv"
    assert editor.run(check())["rows"][0]["verdict"] == "satisfied"
    (folder / "drive.csv").unlink()
    assert editor.run(check())["error"].startswith("there is no file")
    (folder / "drive.csv").write_text("time,brake\n0,1\n")
    assert editor.run(check())["rows"][0]["verdict"] == "error"
    (folder / "drive.csv").write_text(LOG)


def test_a_text_without_a_file_has_verdicts_too(editor):
    uri = "untitled:Untitled-1"
    item = lsp.TextDocumentItem(uri, "stl", 1, "require R: always(speed < 50)\n")
    editor.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
    params = lsp.ExecuteCommandParams("rtamt.check", [uri])
    found = editor.run(editor.client.workspace_execute_command_async(params))
    assert found == {"rows": [{"name": "R", "verdict": "satisfied", "robustness": "10.0"}]}


@pytest.mark.parametrize(
    ("text", "corrected"),
    [
        ('import "pattern.stl"\nalways(p)\n', 'import "patterns.stl"\nalways(p)\n'),
        ("flaot x\nx > 3\n", "float x\nx > 3\n"),
        ("float x\na = alway (x > 3)\n", "float x\na = always (x > 3)\n"),
        ('float "engine speed"\nenginespeed > 3\n', 'float "engine speed"\n"engine speed" > 3\n'),
        ("x > 3 adn x < 5\n", "x > 3 and x < 5\n"),
    ],
)
def test_a_name_that_was_probably_meant_is_a_quick_fix(editor, folder, text, corrected):
    path = folder / "meant.stl"
    (found,) = editor.open(path, text)
    (action,) = editor.ask("code_action", path, range=found.range, context=lsp.CodeActionContext([found]))
    assert list(action.diagnostics) == [found]
    assert apply_edits(text, action.edit.changes[path.as_uri()]) == corrected
    assert [
        each for each in editor.change(path, corrected) if each.severity == lsp.DiagnosticSeverity.Error
    ] == []


def test_a_bound_below_the_period_has_its_code(editor, folder):
    (found,) = editor.open(folder / "short.stl", "sample 100ms  require R: always[0:50ms](x >= 3)\n")
    assert (found.code, found.severity, span_of(found.range)[:2]) == (
        "RT107",
        lsp.DiagnosticSeverity.Error,
        (0, 31),
    )


def test_formatting_changes_white_space_only(editor, folder):
    path, text = folder / "layout.stl", "float x ;\n\n\nalways [0 : 5]( x>=3 )  // fast\n"
    options = lsp.FormattingOptions(tab_size=4, insert_spaces=True)
    editor.open(path, text)
    new = apply_edits(text, editor.ask("formatting", path, options=options))
    assert new == "float x;\n\nalways[0:5](x >= 3)  // fast\n"
    editor.change(path, new)
    assert not editor.ask("formatting", path, options=options)
    editor.change(path, "always(x >= )")
    assert not editor.ask("formatting", path, options=options)


def test_the_server_survives_hostile_texts(editor, folder):
    path = folder / "hostile.stl"
    editor.open(path, "(" * 5000)
    for text in ("/*", '"', "", "\0", "@ topic(", "from os import system\n system x\nx > 3", "enum {" * 100):
        editor.change(path, text)
        for name in ("hover", "completion"):
            editor.ask(name, path, 0, 0)
        editor.ask("semantic_tokens_full", path)
        editor.ask("code_lens", path)
    (found,) = editor.change(path, "x" * (2**20 + 1))
    assert found.message == (
        "the file is too long to be checked while it is edited (1,048,577 characters, at most 1,048,576); "
        "rtamt lint checks it"
    )
