#!/usr/bin/env python3
"""Converts the output of `sinew estimate LOG --series FILE.parquet` for the Rerun viewer.

    python examples/tools/to_rerun.py out/offsets.parquet out/offsets.rrd

Needs rerun-sdk, pandas and pyarrow.
"""

import sys

import pandas as pd
import rerun as rr

source, target = sys.argv[1:]
series = pd.read_csv(source) if source.endswith(".csv") else pd.read_parquet(source)
rr.init("sinew")
rr.save(target)
for (method, joint), rows in series.groupby(["method", "joint"]):
    times = [rr.TimeColumn("recording", duration=rows["time_s"])]
    if rows["time_utc_ns"].notna().all():
        times.append(rr.TimeColumn("utc", timestamp=rows["time_utc_ns"].astype("datetime64[ns]")))
    for name in ("offset_rad", "offset_std_rad", "elongation_m", "strain_ratio"):
        if rows[name].notna().any():
            values = rr.Scalars.columns(scalars=rows[name])
            rr.send_columns(f"{method}/{joint}/{name}", indexes=times, columns=values)
