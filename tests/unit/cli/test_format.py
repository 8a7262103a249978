"""``rtamt format``: files in the common layout, and those that stay as they are."""

import pytest


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(**texts):
        for name, text in texts.items():
            (tmp_path / f"{name}.stl").write_bytes(text.encode())
        return [f"{name}.stl" for name in texts]

    return write


def test_files_are_rewritten_and_keep_their_comments(run, files, tmp_path):
    names = files(one="always( x>=3 ) // fast\n", two="always(x >= 3)\n")
    assert run("format", *names, "--check") == (
        1,
        "one.stl: would change\n1 file has the common layout\n",
        "",
    )
    assert (tmp_path / "one.stl").read_text() == "always( x>=3 ) // fast\n"
    assert run("format", *names) == (0, "one.stl: formatted\n1 file has the common layout\n", "")
    assert (tmp_path / "one.stl").read_text() == "always(x >= 3) // fast\n"
    assert run("format", *names, "--check") == (0, "2 files have the common layout\n", "")


def test_ends_of_lines_and_a_byte_order_mark_stay(run, files, tmp_path):
    names = files(one="\ufefffloat x\r\n\r\n\r\nalways( x>=3 )")
    assert run("format", *names)[0] == 0
    assert (tmp_path / "one.stl").read_bytes() == "\ufefffloat x\r\n\r\nalways(x >= 3)\r\n".encode()


def test_a_file_that_others_import_is_formatted(run, files, tmp_path):
    names = files(shared="def near( x,y )=abs( x-y )<3")
    assert run("format", *names)[0] == 0
    assert (tmp_path / "shared.stl").read_text() == "def near(x, y) = abs(x - y) < 3\n"


def test_a_wrong_file_is_an_error_and_stays_as_it_is(run, files, tmp_path):
    names = files(wrong="always(x >= )", good="x >= 3\n")
    code, out, errors = run("format", *names, "missing.stl")
    assert (code, out) == (2, "1 file has the common layout\n")
    assert errors == (
        "rtamt: wrong.stl: expected an operand after '>=', got ')'\n  line 1, column 13:\n    always(x >= )\n"
        "                ^\nrtamt: cannot read 'missing.stl': No such file or directory\n"
    )
    assert (tmp_path / "wrong.stl").read_text() == "always(x >= )"
