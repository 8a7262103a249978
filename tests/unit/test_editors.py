"""The extension for Visual Studio Code: its manifest, its files, and the server that it starts."""

import json
import re
from pathlib import Path

from rtamt.cli import COMMANDS

FOLDER = Path(__file__).parents[2] / "editors" / "vscode"
MANIFEST = json.loads((FOLDER / "package.json").read_text())
SCRIPT = (FOLDER / "extension.js").read_text()
GIVEN = MANIFEST["contributes"]


def test_the_manifest_names_files_that_are_there_or_copied():
    copied = re.findall(r'\["([^"]+)", "([^"]+)"\]', (FOLDER / "prepare.js").read_text())
    for source, _name in copied:
        assert (FOLDER / source).is_file()
    there = {each.name for each in FOLDER.iterdir()} | {name for _source, name in copied}
    (language,), (grammar,) = GIVEN["languages"], GIVEN["grammars"]
    for path in (MANIFEST["main"], language["configuration"], grammar["path"]):
        assert path.removeprefix("./") in there


def test_the_extension_wakes_for_specifications():
    (language,), (grammar,) = GIVEN["languages"], GIVEN["grammars"]
    assert MANIFEST["activationEvents"] == [f"onLanguage:{language['id']}"]
    assert language["extensions"] == [".stl"]
    assert grammar["language"] == language["id"]
    made = json.loads((FOLDER / "../stl.tmLanguage.json").read_text())
    assert grammar["scopeName"] == made["scopeName"]
    assert f'language: "{language["id"]}"' in SCRIPT


def test_the_commands_are_those_that_the_script_registers():
    registered = set(re.findall(r'registerCommand\("([^"]+)"', SCRIPT))
    assert registered == {each["command"] for each in GIVEN["commands"]}


def test_the_settings_are_those_of_the_server():
    from rtamt.lsp import session

    own = {f"rtamt.{name}" for name in vars(session.Settings())} | {"rtamt.command"}
    assert set(GIVEN["configuration"]["properties"]) == own
    for name, each in GIVEN["configuration"]["properties"].items():
        if name != "rtamt.command":
            assert each["default"] == getattr(session.Settings(), name.removeprefix("rtamt."))
    command, *arguments = GIVEN["configuration"]["properties"]["rtamt.command"]["default"]
    assert (command, arguments[0] in COMMANDS) == ("rtamt", True)


def test_the_server_is_not_chosen_by_an_untrusted_workspace():
    restricted = MANIFEST["capabilities"]["untrustedWorkspaces"]["restrictedConfigurations"]
    assert {"rtamt.command", "rtamt.recording"} <= set(restricted)
