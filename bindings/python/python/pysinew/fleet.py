"""Recordings to records, and records to trends, on engines that spread work over many machines by Arrow: Spark and its like.

    >>> from pysinew import fleet
    >>> types = {"biorob-like": "/robots/biorob-like"}                   # the same path on every machine
    >>> records = recordings.mapInArrow(fleet.sessions(types), fleet.SESSIONS)
    >>> trends = records.groupBy("robot", "joint").applyInArrow(fleet.trend(types), fleet.TREND)

Each row is one recording or one tendon. A trend is the row that ``sinew-fleet`` gives: the same selection of sessions and the same
numbers. A repeated computation gives the same result. A rejected input has its reason in ``rejection`` and does not affect other
results. Paths may be addresses such as ``s3://BUCKET/KEY``, read by pyarrow with the environment variables of ``sinew-fleet``.
"""

from __future__ import annotations

import contextlib
import csv
import math
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from . import results
    from ._core import Robot

_RECORD = {
    "robot": "string",
    "robot_type": "string",
    "joint": "string",
    "time_utc_s": "double",
    "duration_s": "double",
    "offset_rad": "double",
    "offset_std_rad": "double",
    "elongation_m": "double",
    "elongation_std_m": "double",
    "strain_ratio": "double",
    "strain_std_ratio": "double",
    "temperature_c": "double",
    "stiffness_ratio": "double",
    "stiffness_std_ratio": "double",
    "baseline": "string",
    "source": "string",
    "clock": "string",
    "provisional": "boolean",
    "reason": "string",
    "poses": "bigint",
    "frames": "bigint",
    "frames_lost": "bigint",
    "sinew_version": "string",
    "rejection": "string",
}
_TREND = {
    "robot": "string",
    "joint": "string",
    "verdict": "string",
    "offset_rad": "double",
    "offset_std_rad": "double",
    "elongation_m": "double",
    "elongation_std_m": "double",
    "rate_rad_per_s": "double",
    "rate_std_rad_per_s": "double",
    "steps": "bigint",
    "sessions": "bigint",
    "tensioned_utc_s": "double",
    "last_utc_s": "double",
    "limit": "string",
    "state": "string",
    "after_s": "double",
    "after_low_s": "double",
    "after_high_s": "double",
    "rejection": "string",
}
# Unit of a column by the end of its name.
_UNITS = {"_rad_per_s": "rad/s", "_rad": "rad", "_m": "m", "_s": "s", "_c": "°C", "_ratio": "1"}


def _words(columns: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {kind}" for name, kind in columns.items())


SESSIONS = _words(_RECORD)
"""Columns that ``sessions`` gives, as Spark writes them: those of ``sinew-record/2``, and ``rejection``."""
TREND = _words(_TREND)
"""Columns that ``trend`` gives, as Spark writes them: those of ``sinew_trend(*)`` and, in seconds, ``sinew_days_until(*)`` of ``sinew-fleet``."""


def _arrow(columns: Mapping[str, str]) -> Any:
    import pyarrow as pa

    kinds = {"string": pa.string(), "double": pa.float64(), "bigint": pa.int64(), "boolean": pa.bool_()}

    def field(name: str, kind: str) -> Any:
        unit = next((unit for end, unit in _UNITS.items() if name.endswith(end)), "")
        return pa.field(name, kinds[kind], metadata={"unit": unit} if unit and kind == "double" else None)

    return pa.schema([field(name, kind) for name, kind in columns.items()])


def _store(address: str) -> tuple[Any, str]:
    """The file system of an address, and the path in it."""
    import pyarrow as pa
    from pyarrow import fs

    from . import SinewError

    parts = urlsplit(address)
    if parts.scheme != "s3":
        try:
            found: tuple[Any, str] = fs.FileSystem.from_uri(address)
        except pa.ArrowInvalid as error:
            raise SinewError(f"{address}: {error}") from None
        return found
    endpoint = os.environ.get("AWS_ENDPOINT_URL_S3") or os.environ.get("AWS_ENDPOINT_URL", "")
    server = urlsplit(endpoint)
    if endpoint and not server.netloc:
        raise SinewError(f"AWS_ENDPOINT_URL is '{endpoint}'; expected a form such as https://HOST:PORT")
    options = {"scheme": server.scheme, "endpoint_override": server.netloc} if endpoint else {}
    region = os.environ.get("AWS_REGION") or os.environ.get("AWS_DEFAULT_REGION")
    anonymous = os.environ.get("AWS_SKIP_SIGNATURE") == "true"
    return fs.S3FileSystem(anonymous=anonymous, region=region, **options), parts.netloc + parts.path


@contextlib.contextmanager
def _local(place: str) -> Iterator[str]:
    """A file or folder on this machine: an address is copied for as long as it is in use."""
    if "://" not in place:
        yield place
        return
    from pyarrow import fs

    store, path = _store(place)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / (path.rstrip("/").rpartition("/")[2] or "copy")
        kind = store.get_file_info(path).type
        if kind == fs.FileType.NotFound:
            raise FileNotFoundError(f"{place}: not found")
        if kind == fs.FileType.Directory:
            copy.mkdir()
            fs.copy_files(path, str(copy), source_filesystem=store, destination_filesystem=fs.LocalFileSystem())
        else:
            with store.open_input_stream(path) as source, copy.open("wb") as out:
                while block := source.read(1 << 20):
                    out.write(block)
        yield str(copy)


class _Types:
    """Descriptions of robot types. Only their paths travel to other machines; each reads a type once."""

    def __init__(self, places: Mapping[str, str]) -> None:
        self.places = {name: str(place) for name, place in places.items()}
        self.read: dict[str, Robot] = {}

    def __reduce__(self) -> tuple[type[_Types], tuple[dict[str, str]]]:
        return _Types, (self.places,)

    def find(self, name: str) -> Robot:
        from . import Robot, SinewError

        if name not in self.places:
            raise SinewError(f"robot type '{name}' has no folder; types are given for {', '.join(self.places) or 'none'}")
        if name not in self.read:
            with _local(self.places[name]) as place:
                self.read[name] = Robot(place)
        return self.read[name]


class _Sessions:
    def __init__(self, types: Mapping[str, str]) -> None:
        self.types = _Types(types)

    def __call__(self, batches: Iterator[Any]) -> Iterator[Any]:
        import pyarrow as pa

        schema = _arrow(_RECORD)
        for batch in batches:
            for recording in batch.to_pylist():
                # A batch per recording: no more is in memory.
                yield pa.RecordBatch.from_pylist(self.records(recording), schema=schema)

    def records(self, recording: Mapping[str, Any]) -> list[dict[str, Any]]:
        from . import SinewError, __version__, estimate

        row = dict.fromkeys(_RECORD)
        row |= {
            "robot": recording["robot"],
            "robot_type": recording["robot_type"],
            "source": recording["path"],
            "sinew_version": __version__,
        }
        try:
            robot = self.types.find(recording["robot_type"])
            with _local(recording["path"]) as path, _local(recording.get("baseline") or "") as baseline:
                found = estimate(path, robot, baseline=baseline or None, method="absolute")
            session = found.session
            if session is None or session.start_time_utc_s is None:
                raise SinewError(f"{recording['path']}: its clock has no civil date, so it is no session of a trend")
        # A file that is missing is an OSError; both are about this recording alone.
        except (SinewError, OSError) as error:
            return [row | {"rejection": str(error)}]
        reading = found.reading
        used = {joint.name: joint.usable_frames for joint in reading.joints} if reading else {}
        row |= {
            "time_utc_s": session.start_time_utc_s,
            "duration_s": session.duration_s,
            "temperature_c": session.temperature_c,
            "baseline": session.baseline,
            "clock": "utc",
            "provisional": False,
            "poses": session.poses,
        }
        rows = []
        for joint in session.joints:
            frames = used.get(joint.name)
            lost = reading.recording.frames - frames if reading and frames is not None else None
            rows.append(row | self.tendon(joint) | {"frames": frames, "frames_lost": lost})
        return rows

    @staticmethod
    def tendon(joint: results.TendonEstimate) -> dict[str, Any]:
        # As in the monitor: an inconclusive result is not an offset. Strain refers to the new rope, which is not
        # available from a recording.
        stiffness = joint.stiffness_change_ratio
        row = {
            "joint": joint.name,
            "stiffness_ratio": stiffness and stiffness.mean,
            "stiffness_std_ratio": stiffness and stiffness.std,
        }
        if joint.verdict == "inconclusive":
            return row | {"reason": "too-wide"}
        return row | {
            "offset_rad": joint.offset_rad.mean,
            "offset_std_rad": joint.offset_rad.std,
            "elongation_m": joint.elongation_m and joint.elongation_m.mean,
            "elongation_std_m": joint.elongation_m and joint.elongation_m.std,
        }


def sessions(types: Mapping[str, str]) -> Callable[[Iterator[Any]], Iterator[Any]]:
    """Records of recordings, for ``mapInArrow``; the columns are ``SESSIONS``.

    Input rows have the columns ``path`` (a recording, with a path that is valid on every machine), ``robot``, ``robot_type`` and, if there is one,
    ``baseline`` (a file). The output has one row per tendon. A rejected recording yields one row with the reason and without a joint.

    Parameters
    ----------
    types
        Folder of each robot type, by its name, with a path that is valid on every machine.

    Returns
    -------
    callable
        From batches of recordings to batches of records.
    """
    return _Sessions(types)


def _order_of(version: str | None) -> tuple[Any, ...]:
    """Order of versions: 0.10.0 is later than 0.9.2 and than its own 0.10.0-rc.1."""
    if version is None:
        return ()
    numbers, _, rest = version.partition("-")
    return [int(n) if n.isdecimal() else 0 for n in numbers.split(".")], not rest, rest


def _once(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Each session once, in order of time: by the newest version, then with the most frames, then with the narrowest interval.

    A row without a finite time is no session.
    """

    def last(value: Any) -> tuple[int, Any]:
        # As in SQL: NaN after all numbers, and missing values after NaN.
        if value is None:
            return 2, None
        return (1, None) if value != value else (0, value)

    rows = [row for row in rows if row["time_utc_s"] is not None and math.isfinite(row["time_utc_s"])]
    rows.sort(key=lambda row: [last(row[name]) for name in ("offset_std_rad", "offset_rad", "source", "baseline")])
    rows.sort(key=lambda row: math.inf if row["frames"] is None else -row["frames"])
    rows.sort(key=lambda row: _order_of(row["sinew_version"]), reverse=True)
    found: dict[float, dict[str, Any]] = {}
    for row in rows:
        found.setdefault(row["time_utc_s"], row)
    return [found[at] for at in sorted(found)]


def _sides(folder: str | None) -> tuple[dict[tuple[str, str], str], dict[tuple[str, str], list[tuple[str, bool]]]]:
    """Ropes and events of tendons, from ``tendons.csv`` and ``events.csv`` of a folder."""
    from . import SinewError

    ropes: dict[tuple[str, str], str] = {}
    events: dict[tuple[str, str], list[tuple[str, bool]]] = {}
    missing: list[str] = []

    def rows(name: str, columns: set[str]) -> Iterator[tuple[tuple[str, str], dict[str, str]]]:
        try:
            with _local(f"{folder}/{name}") as path, open(path, encoding="utf-8-sig", newline="") as file:
                table = csv.DictReader(line for line in file if not line.startswith("#"))
                found = table.fieldnames or ()
                if absent := columns - set(found):
                    raise SinewError(f"{folder}/{name} has no column '{min(absent)}'; columns are {', '.join(found)}")
                for row in table:
                    if empty := [column for column in sorted(columns) if not row[column]]:
                        raise SinewError(f"{folder}/{name}: '{empty[0]}' is missing; it is required in every row")
                    yield (row["robot"], row["joint"]), row
        except FileNotFoundError:
            missing.append(name)

    if folder is not None:
        for tendon, row in rows("tendons.csv", {"robot", "joint"}):
            if row.get("rope"):
                ropes[tendon] = row["rope"]
        for tendon, row in rows("events.csv", {"robot", "joint", "time_utc_s", "event"}):
            if row["event"] not in ("tensioned", "replaced", "installed", "broken"):
                raise SinewError(f"{folder}/events.csv: '{row['event']}' must be tensioned, replaced, broken or installed")
            if row["event"] != "broken":
                events.setdefault(tendon, []).append((row["time_utc_s"], row["event"] != "tensioned"))
        if len(missing) == 2:
            raise SinewError(f"{folder} has neither tendons.csv nor events.csv; omit it if there are none")
    return ropes, events


class _Trend:
    def __init__(self, types: Mapping[str, str], folder: str | None) -> None:
        self.types = _Types(types)
        self.ropes, self.events = _sides(folder)

    def __call__(self, table: Any) -> Any:
        import pyarrow as pa

        rows = table.to_pylist()
        row = dict.fromkeys(_TREND) | {"robot": rows[0]["robot"], "joint": rows[0]["joint"]}
        return pa.Table.from_pylist([row | self.of((row["robot"], row["joint"]), rows)], schema=_arrow(_TREND))

    def of(self, tendon: tuple[Any, Any], rows: list[dict[str, Any]]) -> dict[str, Any]:
        from . import SinewError
        from ._core import tendon_trend

        def number(row: Mapping[str, Any], name: str) -> float | None:
            value = row[name]
            return None if value is None or not math.isfinite(value) else value

        def session(row: Mapping[str, Any]) -> tuple[Any, ...]:
            names = "offset_rad", "offset_std_rad", "temperature_c", "stiffness_ratio", "stiffness_std_ratio"
            return row["baseline"], row["time_utc_s"], number(row, "duration_s"), *(number(row, name) for name in names)

        dated = [
            row
            for row in _once(rows)
            if row["clock"] == "utc" and number(row, "offset_rad") is not None and (number(row, "offset_std_rad") or 0.0) > 0.0
        ]
        try:
            if not dated:
                raise SinewError("no session with a date and an offset")
            robot = self.types.find(dated[0]["robot_type"])
            sessions: list[Any] = [session(row) for row in dated]
            return tendon_trend(robot, tendon[1], self.ropes.get(tendon), sessions, self.events.get(tendon, []))
        except (SinewError, OSError) as error:
            return {"rejection": str(error)}


def trend(types: Mapping[str, str], folder: str | None = None) -> Callable[[Any], Any]:
    """The trend of a tendon, for ``applyInArrow`` by robot and joint; the columns are ``TREND``.

    The input is all records of a tendon, in any order. The result is one row: offset, creep rate, the limit that is exceeded first
    and the time until then, with a 95 % interval. Of a session that was estimated several times, the newest version counts.
    Records without a civil date or an offset are ignored.

    Parameters
    ----------
    types
        Folder of each robot type, by its name, with a path that is valid on every machine.
    folder
        Folder with ``tendons.csv``, ``events.csv`` or both, read once here, where this function is called.

    Returns
    -------
    callable
        From the records of a tendon to one row; a rejected input has its reason in ``rejection``.

    Raises
    ------
    SinewError
        If the folder has neither file, or a file is invalid.
    """
    follow = _Trend(types, folder)
    # Spark looks at annotations to find out what a function takes; one without takes a table.
    return lambda table: follow(table)
