"""Writes the Parquet files of this folder with pandas, pyarrow, Polars and fastparquet.

pip install pandas pyarrow polars fastparquet && python make.py
"""

import decimal
import math

import fastparquet
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

COUNT = 40
JOINTS = range(1, 8)


def swing() -> pd.DataFrame:
    """The test motion of the Rust tests, at 250 Hz."""
    t_s = [0.004 * k for k in range(COUNT)]
    joints = {f"joint_{j}_rad": [0.5 * math.sin(j * t) for t in t_s] for j in JOINTS}
    return pd.DataFrame({"t_s": t_s, **joints})


def steps() -> dict[str, np.ndarray]:
    """Whole degrees, with repeated values."""
    return {f"joint_{j}_deg": np.array([k // 4 + j for k in range(COUNT)]) for j in JOINTS}


def main() -> None:
    frame = swing()
    for codec in ["snappy", "gzip", "brotli", "lz4", "zstd", "none"]:
        frame.to_parquet(f"{codec}.parquet", compression=None if codec == "none" else codec)

    table = pa.Table.from_pandas(frame, preserve_index=False)
    split = [name for name in table.column_names if name != "t_s"]
    pq.write_table(
        table,
        "v2.parquet",
        data_page_version="2.0",
        use_dictionary=False,
        column_encoding={"t_s": "PLAIN", **dict.fromkeys(split, "BYTE_STREAM_SPLIT")},
        compression={"t_s": "gzip", **dict.fromkeys(split, "none")},
        row_group_size=16,
        write_page_checksum=True,
        data_page_size=64,
    )

    degrees = steps()
    kinds = [pa.uint8(), pa.int8(), pa.uint16(), pa.int16(), pa.float16(), pa.float32(), pa.int64()]
    columns = {"time": pa.array([1_700_000_000_000_000_000 + 4_000_000 * k for k in range(COUNT)])}
    columns["time"] = columns["time"].cast(pa.timestamp("ns"))
    for (name, values), kind in zip(degrees.items(), kinds, strict=True):
        values = values.astype(np.float16) if kind == pa.float16() else values
        columns[name] = pa.array(values, type=kind)
    columns |= {
        f"torque_{j}_nm": pa.array([decimal.Decimal(k * j) / 100 for k in range(COUNT)])
        for j in JOINTS
    }
    pq.write_table(pa.table(columns), "types.parquet", store_decimal_as_integer=False)

    columns = {
        "ZeitInSec": pa.array(np.full(COUNT, 1_700_000_000)),
        "ZeitInNanoSec": pa.array(np.arange(COUNT) * 4_000_000, type=pa.uint32()),
    }
    columns |= {
        name: pa.array(values, type=pa.int32() if name < "joint_4" else pa.uint64())
        for name, values in degrees.items()
    }
    pq.write_table(
        pa.table(columns),
        "differences.parquet",
        use_dictionary=False,
        column_encoding="DELTA_BINARY_PACKED",
    )

    missing = swing()
    missing.loc[11, "joint_3_rad"] = math.nan
    missing.to_parquet("null.parquet")

    named = swing()
    named.insert(0, "a, b", "x" * 20)
    named.insert(3, "note; remark", [[1, 2]] * COUNT)
    named["\tstate"] = [{"t_s": k, "joint_1_rad": 9} for k in range(COUNT)]
    named.columns = [f" {name}" if name == "joint_5_rad" else name for name in named.columns]
    named.to_parquet("names.parquet", compression=None)

    text = swing()
    text["joint_2_rad"] = text["joint_2_rad"].astype(str)
    text.to_parquet("text.parquet")

    pl.from_pandas(frame).write_parquet("polars.parquet")
    fastparquet.write("fastparquet.parquet", frame)


if __name__ == "__main__":
    main()
