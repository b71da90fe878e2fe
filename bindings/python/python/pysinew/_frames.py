"""Data frames, labelled arrays, times and file objects as the input of a recording."""

from __future__ import annotations

import datetime
import os
from typing import TYPE_CHECKING, Any, Sequence

from ._errors import SinewError

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory

    from ._core import Recording

# First bytes of the formats, and their endings; other files are text.
_MAGIC = ((b"\x89MCAP", ".mcap"), (b"PAR1", ".parquet"), (b"SQLite format 3", ".db3"), (b"\x93NUMPY", ".npy"), (b"PK", ".npz"))
# Suffix of the columns of each quantity, as recordings name them.
_SUFFIXES = {"q": "_rad", "theta": "_rad", "dq": "_rad_per_s", "tau_el": "_nm", "tau_m": "_nm", "tau_ext": "_nm"}


def is_content(log: Any) -> bool:
    """Whether a recording is given by its content: bytes or an open file."""
    return isinstance(log, (bytes, bytearray, memoryview)) or hasattr(log, "read")


def place(log: Any) -> tuple[str, str, TemporaryDirectory[str] | None]:
    """Path and name of a recording, and the owner of its temporary file where it is given by its content."""
    if not is_content(log):
        path = os.fsdecode(os.fspath(log))
        return path, path, None
    import tempfile

    content = log.read() if hasattr(log, "read") else log
    if isinstance(content, str):
        content = content.encode()
    content = bytes(content)
    name = getattr(log, "name", None)
    ending = os.path.splitext(name)[1] if isinstance(name, str) else ""
    ending = ending or next((own for magic, own in _MAGIC if content.startswith(magic)), ".csv")
    owner = tempfile.TemporaryDirectory(prefix="pysinew-")
    path = os.path.join(owner.name, "recording" + ending)
    with open(path, "wb") as file:
        file.write(content)
    return path, name if isinstance(name, str) else "recording" + ending, owner


def restored(place: Any, name: str, keywords: dict[str, Any]) -> Recording:
    """The recording that ``pickle`` kept: a path, the content of a file, or arrays."""
    from ._core import Recording

    if isinstance(place, dict):
        return Recording.from_arrays(**place, name=name, **keywords)
    if isinstance(place, bytes):
        import io

        file = io.BytesIO(place)
        file.name = name
        place = file
    return Recording(place, **keywords)


def _names(value: Any) -> list[str] | None:
    """Names of the columns of a data frame or a labelled array; ``None`` where they have none."""
    columns = getattr(value, "columns", None)
    if columns is None and hasattr(value, "dims") and hasattr(value, "coords"):
        # An array of xarray: its last dimension is the joints'.
        coordinate = value.coords.get(value.dims[-1]) if value.ndim == 2 else None
        columns = None if coordinate is None else coordinate.values
    if columns is None and hasattr(value, "column_names"):
        columns = value.column_names
    if columns is None:
        return None
    names = list(columns)
    # Columns that are only numbered have no names.
    return [str(name) for name in names] if any(isinstance(name, str) for name in names) else None


def _joint(name: str, symbol: str) -> str:
    """Joint of a column: ``elbow``, ``q.elbow``, ``q.elbow_rad``."""
    own = name.removeprefix(symbol + ".")
    return own.removesuffix(_SUFFIXES[symbol]) if own != name else name


def _columns(value: Any, names: list[str], picked: list[int]) -> Any:
    import numpy as np

    if hasattr(value, "iloc"):
        return value.iloc[:, picked].to_numpy(dtype=np.float64, na_value=np.nan)
    if hasattr(value, "to_numpy") and hasattr(value, "select"):
        return value.select([names[i] for i in picked]).to_numpy()
    if hasattr(value, "column_names"):
        return np.column_stack([np.asarray(value[names[i]]) for i in picked])
    return np.asarray(value)[:, picked]


def arranged(joints: Sequence[str] | None, given: dict[str, Any]) -> tuple[list[str], Any, dict[str, Any]]:
    """Joints, times of the index of a data frame, and the arrays with their columns in the order of the joints.

    Columns with names are found by name, so that their order has no effect; columns without are in the order of ``joints``.
    """
    out = {}
    index = None
    for symbol, value in given.items():
        names = _names(value)
        times = getattr(value, "index", None)
        if index is None and times is not None and getattr(getattr(times, "dtype", None), "kind", "") == "M":
            index = times
        if names is None:
            out[symbol] = value
            continue
        of_joint = {_joint(name, symbol): i for i, name in enumerate(names)}
        if len(of_joint) < len(names):
            raise SinewError(f"{symbol} has two columns of one joint: {', '.join(names)}")
        joints = list(of_joint) if joints is None else list(joints)
        missing = [joint for joint in joints if joint not in of_joint]
        if missing:
            raise SinewError(
                f"{symbol} has no column of joint {', '.join(missing)}; its columns are {', '.join(names)}; "
                f"rename them, or pass {symbol}.to_numpy() with the columns in the order of the joints"
            )
        out[symbol] = _columns(value, names, [of_joint[joint] for joint in joints])
    if joints is None:
        raise SinewError("joints is needed, because the columns of q have no names")
    return list(joints), index, out


def clock(times: Any) -> Any:
    """Times as integers or ``datetime64`` in UTC. A time without a zone is UTC."""
    import numpy as np

    if hasattr(times, "dt") and hasattr(times.dt, "tz_convert"):
        # A series of pandas.
        if times.dt.tz is not None:
            times = times.dt.tz_convert("UTC").dt.tz_localize(None)
    elif hasattr(times, "tz_convert") and getattr(times, "tz", None) is not None:
        times = times.tz_convert("UTC").tz_localize(None)
    array = np.asarray(times)
    if array.dtype.kind != "O":
        return array
    return np.array([_utc(time) for time in array.ravel()], dtype="datetime64[ns]").reshape(array.shape)


def _utc(time: Any) -> Any:
    import numpy as np

    if isinstance(time, datetime.datetime):
        if time.tzinfo is not None:
            time = time.astimezone(datetime.timezone.utc)
        if hasattr(time, "to_datetime64"):
            return time.to_datetime64()
        return np.datetime64(time.replace(tzinfo=None), "ns")
    if isinstance(time, datetime.date):
        return np.datetime64(time, "ns")
    if isinstance(time, np.datetime64):
        return time
    raise TypeError("time_ns must hold whole numbers, datetime64 or datetimes; give seconds as time_s")


def day(date: Any) -> str:
    """A day or time as text: a text, or a date or time of ``datetime``, NumPy or pandas. A time without a zone is UTC."""
    import numpy as np

    if isinstance(date, str):
        return date
    if isinstance(date, np.datetime64):
        date = date.astype("datetime64[us]").item()
    if isinstance(date, datetime.datetime):
        if date.tzinfo is not None:
            date = date.astimezone(datetime.timezone.utc).replace(tzinfo=None)
        return f"{date:%Y-%m-%dT%H:%M:%SZ}"
    if isinstance(date, datetime.date):
        return str(date.isoformat())
    raise TypeError(f"a date must be a text, a date or a datetime, not {type(date).__name__}")
