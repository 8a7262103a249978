"""Suites on Ray Data, on this machine."""

from __future__ import annotations

import pytest

from rtamt.scale.engines import check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of
from tests.unit.scale.recorded import suite, write_csv

pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(autouse=True)
def cluster():
    import ray

    yield
    ray.shutdown()


def test_paths_have_the_same_table_as_the_local_engine(tmp_path):
    from rtamt.scale import ray

    for i in range(3):
        write_csv(tmp_path / f"{i}.csv", i)
    (tmp_path / "bad.parquet").write_bytes(b"PAR1 and no more")
    recordings = recordings_of([str(tmp_path)])
    local = list(check_recordings(Job(suite()), recordings, jobs=1))
    rows = sorted(tuple(row.values()) for row in ray.check([str(tmp_path)], suite()).take_all())
    assert rows == sorted(tuple(row) for table in local for row in table)
    assert list(check_recordings(Job(suite()), recordings, engine="ray", jobs=1)) == local
