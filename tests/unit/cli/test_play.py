"""``rtamt play``: what the command line gives to the page, and its errors."""

import socket
import sys

import pytest

from rtamt.cli.parser import Parser
from rtamt.cli.play import _page_state, configure


def given(*arguments):
    parser = Parser()
    configure(parser)
    return _page_state(parser.read(list(arguments)))


def test_a_file_gives_its_text_its_name_and_the_folder_of_its_imports(tmp_path, write, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write("limits.stl", "\ufeffalways(x >= 3)\n")
    found, folder, fragment = given("limits.stl", "--time", "dense")
    assert (found.text, found.name, found.time) == ("always(x >= 3)\n", "limits.stl", "dense")
    assert (folder, fragment) == (str(tmp_path), "")


def test_a_formula_a_pack_and_a_link():
    assert given("always(x >= 3)")[0].text == "always(x >= 3)"
    found, folder, _ = given("pack:px4")
    assert "require" in found.text
    assert (found.name, folder) == ("px4", None)
    assert given("http://127.0.0.1:8000/#1abc")[2] == "#1abc"
    assert given()[0].text == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["missing.stl"], "rtamt: there is no file 'missing.stl'\n"),
        (["x > 0", "missing.csv"], "rtamt: there is no recording 'missing.csv'\n"),
        (
            ["http://127.0.0.1/"],
            "rtamt: the link 'http://127.0.0.1/' contains nothing: it must have a part after '#'\n",
        ),
        (["x > 0", "--time", "lunar"], "rtamt: unknown time domain 'lunar'; time domains: discrete, dense\n"),
        (
            ["--port", "70000"],
            "rtamt: cannot listen on port 70000: bind(): port must be 0-65535.; choose another one with --port\n",
        ),
    ],
)
def test_errors_are_one_sentence(run, arguments, message):
    assert run("play", "--no-browser", *arguments) == (2, "", message)


def test_a_file_of_another_kind_is_one_sentence(run, tmp_path):
    (tmp_path / "unit.fmu").write_bytes(b"PK\xe6")
    unit = str(tmp_path / "unit.fmu")
    assert run("play", "--no-browser", unit).err == (
        f"rtamt: '{unit}' is not UTF-8 text (byte 2); is it a specification?\n"
    )
    assert run("play", "--no-browser", "x > 0", unit).err.startswith(
        f"rtamt: cannot tell how to read '{unit}': its name ends in none of .csv, "
    )


def test_a_port_in_use_is_one_sentence(run):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert run("play", "--no-browser", "--port", str(port)) == (
            2,
            "",
            f"rtamt: cannot listen on port {port}: Address already in use; choose another one with --port\n",
        )


@pytest.mark.parametrize("name", ["starlette", "uvicorn"])
def test_without_its_packages_the_message_names_the_extra(run, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    assert run("play") == (
        2,
        "",
        f"rtamt: rtamt play needs the package '{name}', which is not installed: pip install 'rtamt[play]'\n",
    )
