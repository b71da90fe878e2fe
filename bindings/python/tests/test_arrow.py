"""Arrow out: other libraries see the memory of the table, by address."""

from __future__ import annotations

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, SHIPPED


@pytest.fixture(scope="module")
def table() -> sn.Table:
    import os

    from conftest import ROOT

    os.chdir(ROOT)
    return sn.Recording(SHIPPED).table()


def addresses(table: sn.Table) -> dict[str, int]:
    """Memory addresses of the columns, as reported by pyarrow."""
    pa = pytest.importorskip("pyarrow")
    seen = pa.table(table)
    return {name: seen[name].chunk(0).buffers()[1].address for name in seen.column_names}


def test_pyarrow_reads_the_memory_of_the_table(table: sn.Table) -> None:
    pa = pytest.importorskip("pyarrow")
    # Two streams of one table show the same addresses: neither copied.
    assert addresses(table) == addresses(table)
    seen = pa.table(table)
    assert seen.column_names == table.column_names and seen.num_rows == len(table)
    assert (seen["q.elbow_rad"].to_numpy() == table["q.elbow_rad"]).all()
    assert pa.schema(table).names == table.column_names


def test_the_table_outlives_its_owner() -> None:
    pa = pytest.importorskip("pyarrow")
    own = sn.Recording(SHIPPED).table(joints=["elbow"])
    wanted = own["theta.elbow_rad"].copy()
    seen = pa.table(own)
    del own
    assert (seen["theta.elbow_rad"].to_numpy() == wanted).all()


def test_polars_reads_the_memory_of_the_table(table: sn.Table) -> None:
    pl = pytest.importorskip("polars")
    frame = pl.DataFrame(table)
    at = addresses(table)
    for name in ("q.elbow_rad", "theta.wrist_rad", "time_ns"):
        # Refused where it would have to copy.
        values = frame[name].to_numpy(allow_copy=False)
        assert values.__array_interface__["data"][0] == at[name], name


def test_pandas_reads_the_memory_of_the_table(table: sn.Table) -> None:
    pd = pytest.importorskip("pandas")
    pa = pytest.importorskip("pyarrow")
    at = addresses(table)
    for name in ("q.elbow_rad", "time_ns"):
        values = pa.table(table)[name].chunk(0).to_numpy(zero_copy_only=True)
        assert values.__array_interface__["data"][0] == at[name], name
    if not hasattr(pd.DataFrame, "from_arrow"):
        pytest.skip("SKIPPED: this pandas has no DataFrame.from_arrow")
    frame = pd.DataFrame.from_arrow(table)
    assert list(frame.columns) == table.column_names
    assert (frame["q.elbow_rad"].to_numpy() == table["q.elbow_rad"]).all()


def test_duckdb_queries_table(table: sn.Table) -> None:
    duckdb = pytest.importorskip("duckdb")
    # Results are copied; input is read through the same stream.
    answer = duckdb.sql('select count(*), avg("q.elbow_rad"), max(time_ns) from "table"').fetchall()
    count, mean, last = answer[0]
    assert count == len(table) and last == table["time_ns"].max()
    assert mean == pytest.approx(table["q.elbow_rad"].mean(), rel=1e-12)


def test_answers_are_tables() -> None:
    pa = pytest.importorskip("pyarrow")
    found = sn.estimate(SHIPPED, ROBOT)
    assert found.table_names == ["joints", "series"]
    rows = pa.table(found.table()).to_pylist()
    assert [row["joint"] for row in rows] == ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"]
    elbow = found.joint("elbow")
    row = rows[2]
    assert row["offset_rad"] == elbow.offset_rad.mean
    assert row["offset_std_rad"] == elbow.offset_rad.std
    assert row["verdict"] == "offset-detected" and row["error"] is None
    assert pa.table(found.table("series")).num_rows > 100
    with pytest.raises(KeyError, match="available: joints, series"):
        found.table("serie")


def test_columns_without_another_library(table: sn.Table, tmp_path) -> None:
    assert isinstance(table["q.elbow_rad"], np.ndarray)
    with pytest.raises(KeyError, match="did you mean 'q.elbow_rad'"):
        table["q.elbow_rat"]
    table.write(tmp_path / "frames.csv")
    # What is written is a recording again.
    again = sn.Recording(tmp_path / "frames.csv").arrays()
    assert (again["q"] == sn.Recording(SHIPPED).arrays()["q"]).all()
    assert "rows" in repr(table) and "<table" in table._repr_html_()
