"""Any file is read or refused in a sentence, whatever its bytes: in bounded time and memory."""

from __future__ import annotations

import resource
import tempfile
import time
from pathlib import Path
from random import Random

import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyarrow import feather, parquet

import rtamt
from rtamt.errors import TraceError
from tests.fuzz.targets import TARGETS, Target, damaged, good, not_damaged, outcome

# Libraries leave files open that they could not read.
pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::UserWarning"
)

CORPUS = Path(__file__).parent / "corpus" / "files"
#: Of each kind of file, for `make fuzz`: some minutes in all.
MOST_EXAMPLES = 3000
#: A file of some kB takes milliseconds; the rest is for a machine that is busy.
MOST_SECONDS = 20
#: What one file may add to the memory of the process at its largest.
MOST_KILOBYTES = 2**20

cells = st.sampled_from(
    ["0", "1", "2.5", "-1e3", "nan", "inf", "", " ", '"', '"1"', "x", "\x00", "#", "é", "1e999"]
)
rows = st.lists(st.lists(cells, max_size=4).map(",".join), max_size=6)
headers = st.sampled_from(
    ["t,x", "time [ms],x", "x", "t [h],x [V],x", "", "# t,x", "1,2", "t;x", "time,time", "t,,x"]
)
tables = st.tuples(headers, rows, st.sampled_from(["\n", "\r\n", "\r"])).map(
    lambda parts: parts[2].join([parts[0], *parts[1]]).encode()
)


def check(target: Target, data: bytes) -> None:
    """Read a file with these bytes, and hold time and memory to their bounds."""
    began, largest = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with tempfile.TemporaryDirectory() as folder:
        sentence = outcome(target, data, folder)
    assert sentence
    assert time.monotonic() - began < MOST_SECONDS
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - largest < MOST_KILOBYTES


def test_files_of_every_format_are_damaged_here() -> None:
    assert not_damaged() == set()


@pytest.mark.parametrize("target", TARGETS, ids=str)
def test_a_good_file_is_read(target: Target, tmp_path: Path) -> None:
    # A unit is described, not simulated: asked for a variable that it does not have.
    expected = f"'{tmp_path}/log.fmu' has no variable 'nothing'" if target.suffix == ".fmu" else "read"
    assert outcome(target, good(target), str(tmp_path)) == expected


@pytest.mark.parametrize("target", TARGETS, ids=str)
@settings(max_examples=min(settings.default.max_examples, MOST_EXAMPLES))
@given(seed=st.integers(0, 2**63))
def test_a_damaged_file_is_read_or_refused_in_a_sentence(target: Target, seed: int) -> None:
    check(target, damaged(good(target), Random(seed)))


@given(st.binary(max_size=60) | tables)
def test_any_csv_file_is_read_or_refused_in_a_sentence(data: bytes) -> None:
    check(TARGETS[0], data)


def test_a_time_column_of_nothing_but_nulls_is_missing_its_first_stamp(tmp_path: Path) -> None:
    path = tmp_path / "log.arrow"
    feather.write_feather(pa.table({"t": pa.array([None, None], pa.int64()), "x": [1.0, 2.0]}), path)
    with pytest.raises(TraceError) as info:
        rtamt.read(path)
    assert str(info.value) == f"the time column 't' of {path} is empty at sample 0"


def test_a_parquet_file_whose_column_names_are_damaged_is_refused(tmp_path: Path) -> None:
    good = tmp_path / "good.parquet"
    parquet.write_table(pa.table({"t": [0.0], "needle": [1.0]}), good, store_schema=False)
    path = tmp_path / "log.parquet"
    path.write_bytes(good.read_bytes().replace(b"needle", b"\xff\xfeedle"))
    with pytest.raises(TraceError, match="cannot be read as Parquet: 'utf-8' codec can't decode byte 0xff"):
        rtamt.read(path)


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.name)
def test_files_of_the_corpus(path: Path) -> None:
    targets = [target for target in TARGETS if target.suffix == path.suffix]
    assert targets
    for target in targets:
        check(target, path.read_bytes())


@pytest.mark.parametrize("target", TARGETS, ids=str)
def test_a_truncated_file_is_read_or_refused_in_a_sentence(target: Target) -> None:
    data = good(target)
    for end in sorted({*range(0, min(len(data), 64), 7), *(len(data) * i // 40 for i in range(40))}):
        check(target, data[:end])
