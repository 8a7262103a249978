"""The delimiter of a CSV file: that of the header, or of the row below where the header has several."""

import pytest

import rtamt
from rtamt.errors import TraceError


def read(tmp_path, text):
    path = tmp_path / "log.csv"
    path.write_text(text)
    return rtamt.read(path)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("time,x\n0,1\n", ["x"]),
        ("time;x;y\n0;1;2\n", ["x", "y"]),
        ("time\tx\n0\t1\n", ["x"]),
        ("time|x|y\n0|1|2\n", ["x", "y"]),
        ("sep=|\ntime|x\n0|1\n", ["x"]),
        # Characters of names: the row below is not separated by them.
        ("x|y\n1\n2\n", ["x|y"]),
        ("time,a|b|c\n0,1\n", ["a|b|c"]),
        ("time,a;b\n\n# a comment\n0,1\n", ["a;b"]),
        ("time\tx,y\n0\t1\n", ["x,y"]),
        ("time;x [m,n]\n0;1\n", ["x"]),
        ("time;x(a,b);y(a,b)\n0;1;2\n", ["x", "y"]),
        ('"a,b";time\n1;0\n', ["a,b"]),
        ('time;"a,b"\n0;1\n', ["a,b"]),
        ("sep=;\ntime;a,b\n0;1\n", ["a,b"]),
        ("time,a;b\n", ["a;b"]),
    ],
)
def test_names_with_another_delimiter_do_not_move_the_columns(tmp_path, text, names):
    assert list(read(tmp_path, text).names) == names


@pytest.mark.parametrize(
    ("header", "row", "either", "first"),
    [
        ("time,a;b;c", "0,1;2;3", "',' or ';'", ","),
        ("time;a,b;c", "0;1,5;2", "',' or ';'", ","),
        ("time\ta;b", "0\t1;2", "';' or a tab", ";"),
        ("time|a,b", "0|1,5", "',' or '|'", ","),
    ],
)
def test_a_header_that_may_be_separated_in_several_ways_is_no_guess(tmp_path, header, row, either, first):
    with pytest.raises(TraceError) as caught:
        read(tmp_path, f"# a comment\n{header}\n{row}\n")
    assert str(caught.value) == (
        f"{tmp_path / 'log.csv'}, line 2: the columns of '{header}' may be separated by {either}: name it in a first "
        f"line, such as 'sep={first}', or quote the names that contain another"
    )
