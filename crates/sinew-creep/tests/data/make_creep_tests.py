#!/usr/bin/env python3
"""Creep tests as other programs write them: `creep.xlsx` by openpyxl, `creep.parquet` by pandas.

    pip install openpyxl pandas pyarrow
    python3 make_creep_tests.py

One rope of 350 mm at 60 N, read at 0, 60, 180 s; strain 0.2, 0.25, 0.27 %. The tests in
`test_files_of_others.rs` hold every value against these.
"""

import datetime
import decimal
from pathlib import Path

import openpyxl
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

HERE = Path(__file__).resolve().parent
# Files do not change from run to run.
WHEN = datetime.datetime(2026, 1, 1)


def workbook():
    book = openpyxl.Workbook()
    book.properties.created = book.properties.modified = WHEN
    notes = book.active
    notes.title = "Notes"
    notes["A1"] = "No test on this sheet."
    sheet = book.create_sheet("Rope A")
    for row in [
        ["Gauge length", 350, "mm"],
        ["Operator", "K. M."],
        [],
        ["Prüfzeit", "Standardkraft", "Verlängerung", "Remark"],
        ["min", "N", "mm", None],
        [0, 60, 0.7, "start"],
        [1, 60.0, 0.875, "start"],
        # A number typed as text, with a decimal comma.
        [3, 60, "0,945", "start"],
    ]:
        sheet.append(row)
    clock = book.create_sheet("Rope B")
    for row in [
        ["Time (s)", "Force (N)", "Strain (%)"],
        # Excel keeps a time of day as a share of a day.
        [datetime.time(0, 0, 0), 60, 0.2],
        [datetime.time(0, 1, 0), None, 0.25],
        [datetime.time(0, 3, 0), 60, 0.27],
    ]:
        clock.append(row)
    clock["C5"] = "=1/0"
    clock["A5"] = datetime.time(0, 6, 0)
    book.save(HERE / "creep.xlsx")


def columns():
    frame = pd.DataFrame(
        {
            "specimen": pd.Categorical(["A", "A", "A", "B", "B", "B"]),
            "time_min": pd.array([0, 1, 3, 0, 1, 3], dtype="int16"),
            "force_N": pd.array([60, 60, None, 60, 60, 60], dtype="Float32"),
            "strain_%": [0.2, 0.25, 0.27, 0.4, 0.5, float("nan")],
            "temperature_C": pd.Series([decimal.Decimal("23.0")] * 6),
        }
    )
    table = pa.Table.from_pandas(frame, preserve_index=False)
    pq.write_table(table, HERE / "creep.parquet", compression="zstd")


workbook()
columns()
