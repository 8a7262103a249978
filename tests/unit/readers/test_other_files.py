"""Messages about files that are recordings in no known format, or no files."""

import os

import pytest

import rtamt
from rtamt.errors import TraceError

KNOWN = ".csv, .tsv, .txt, .parquet, .pq, .arrow, .feather, .ipc, .xlsx, .xlsm, .ulg, .mf4, .mdf, .bag, .db3, .mcap"


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("log.csv.gz", "; unpack it first"),
        ("log.csv.zst", "; unpack it first"),
        (
            "log.mat",
            "; load it in Python, and give its arrays to rtamt.read as a dict, such as {'time': t, 'speed': v}, "
            "or export it as CSV",
        ),
        (
            "log.JSONL",
            "; 'rtamt monitor SPEC < FILE' reads lines of JSON, and rtamt.read a frame of pandas or polars",
        ),
        (
            "log.sqlite",
            "; '--sql sqlite:///FILE --query TEXT' reads a database, in Python rtamt.read('sqlite:///FILE', query=...)",
        ),
        ("log.xls", "; save it as .xlsx or .csv"),
        (
            "log.BLF",
            "; decode the messages into signals, such as with asammdf, and export these as MDF or CSV",
        ),
        ("run/metadata.yaml", "; give the folder of the bag, 'run'"),
        ("metadata.yaml", "; give the folder of the bag, '.'"),
        ("-", "; 'rtamt monitor' reads samples from stdin"),
        ("log.parket", "; did you mean '.parquet'?"),
        ("log", ""),
    ],
)
def test_the_message_for_a_file_in_no_known_format_names_the_way_to_read_it(path, hint):
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == f"cannot tell how to read '{path}': its name ends in none of {KNOWN}{hint}"


def test_a_pipe_is_rejected_before_anything_waits_for_its_writer(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("log.csv")
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read("log.csv")
    assert str(error.value) == (
        "'log.csv' is a pipe, expected a file; 'rtamt monitor SPEC < PIPE' reads it as a stream"
    )


@pytest.mark.parametrize("suffix", ["csv", "parquet", "arrow", "xlsx", "ulg", "mf4", "mcap", "bag"])
def test_a_link_to_nothing_and_a_folder_were_damaged_files(tmp_path, suffix):
    path = tmp_path / f"log.{suffix}"
    path.symlink_to("nowhere")
    with pytest.raises(TraceError) as caught:
        rtamt.read(path)
    assert str(caught.value) == f"'{path}' is a link to 'nowhere', which does not exist"
    path.unlink()
    path.mkdir()
    with pytest.raises(TraceError) as caught:
        rtamt.read(path)
    expected = f"'{path}' is a directory, expected a file"
    if suffix == "bag":
        expected = f"'{path}' is a folder without metadata.yaml, so that it is no bag of ROS 2; name a file"
    assert str(caught.value) == expected
