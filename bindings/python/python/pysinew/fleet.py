"""Recordings to records, and records to trends, on engines that spread work over many machines by Arrow: Spark and its like.

    >>> from pysinew import fleet
    >>> types = {"biorob-like": "/robots/biorob-like"}                   # the same path on every machine
    >>> records = recordings.mapInArrow(fleet.sessions(types), fleet.SESSIONS)
    >>> trends = records.groupBy("robot", "joint").applyInArrow(fleet.trend(types), fleet.TREND)

Each row is one recording or one tendon, which the functions ``estimate`` and ``trend`` process as a whole. A repeated
computation gives the same result. A rejected input has its reason in ``rejection`` and does not affect other results.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping

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
    "sessions": "bigint",
    "verdict": "string",
    "offset_rad": "double",
    "offset_std_rad": "double",
    "creep_rad_per_s": "double",
    "creep_std_rad_per_s": "double",
    "jumps": "bigint",
    "limit": "string",
    "state": "string",
    "days": "double",
    "days_low": "double",
    "days_high": "double",
    "rejection": "string",
}


def _words(columns: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {kind}" for name, kind in columns.items())


SESSIONS = _words(_RECORD)
"""Columns that ``sessions`` gives, as Spark writes them: those of ``sinew-record/2``, and ``rejection``."""
TREND = _words(_TREND)
"""Columns that ``trend`` gives, as Spark writes them."""


def _arrow(columns: Mapping[str, str]) -> Any:
    import pyarrow as pa

    kinds = {"string": pa.string(), "double": pa.float64(), "bigint": pa.int64(), "boolean": pa.bool_()}
    return pa.schema([(name, kinds[kind]) for name, kind in columns.items()])


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
            self.read[name] = Robot(self.places[name])
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
            found = estimate(recording["path"], robot, baseline=recording.get("baseline"), method="absolute")
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

    * ``types``: the folder of each robot type, by its name, with a path that is valid on every machine.

    Input rows have the columns ``path`` (a recording, with a path that is valid on every machine), ``robot``, ``robot_type`` and, if there is one,
    ``baseline`` (a file). The output has one row per tendon. A rejected recording yields one row with the reason and without a joint.
    """
    return _Sessions(types)


class _Trend:
    def __init__(self, types: Mapping[str, str], horizon_days: float) -> None:
        self.types, self.horizon_days = _Types(types), horizon_days

    def __call__(self, table: Any) -> Any:
        import pyarrow as pa

        # However the engine delivers them.
        table = table.sort_by([("time_utc_s", "ascending"), ("sinew_version", "ascending")])
        columns = table.to_pydict()
        row = dict.fromkeys(_TREND) | {"robot": columns["robot"][0], "joint": columns["joint"][0]}
        return pa.Table.from_pylist([row | self.of(columns)], schema=_arrow(_TREND))

    def of(self, columns: Mapping[str, list[Any]]) -> dict[str, Any]:
        from . import SinewError
        from . import trend as follow

        dated = [
            i for i, (clock, rad) in enumerate(zip(columns["clock"], columns["offset_rad"])) if clock == "utc" and rad is not None
        ]

        def scaled(name: str, factor: float) -> list[float | None]:
            of = (columns[name][i] for i in dated)
            return [None if x is None or math.isnan(x) else factor * x for x in of]

        stiff = columns["stiffness_ratio"]
        table = {
            "time": [columns["time_utc_s"][i] for i in dated],
            "joint": [columns["joint"][i] for i in dated],
            "offset_mrad": scaled("offset_rad", 1e3),
            "interval_95_mrad": scaled("offset_std_rad", 1960.0),
            "temperature_c": scaled("temperature_c", 1.0),
            "duration_s": scaled("duration_s", 1.0),
            "baseline": [columns["baseline"][i] for i in dated],
        }
        if any(stiff[i] is not None for i in dated):
            table["stiffness_change_percent"] = scaled("stiffness_ratio", 100.0)
            table["stiffness_interval_95_percent"] = scaled("stiffness_std_ratio", 196.0)
        try:
            if not dated:
                raise SinewError("no session with a date and an offset")
            robot = self.types.find(columns["robot_type"][0])
            (joint,) = follow(table, robot, horizon_days=self.horizon_days).joints
        except SinewError as error:
            return {"rejection": str(error)}
        return self.row_of(joint)

    @staticmethod
    def row_of(joint: results.JointTrend) -> dict[str, Any]:
        day_s = 86_400.0

        def order(limit: results.LimitForecast) -> tuple[bool, float]:
            return limit.state != "passed", math.inf if limit.after_s is None else limit.after_s

        first = min(joint.limits, key=order, default=None)
        out: dict[str, Any] = {
            "sessions": joint.sessions,
            "verdict": joint.verdict,
            "offset_rad": joint.offset_rad.mean,
            "offset_std_rad": joint.offset_rad.std,
            "creep_rad_per_s": joint.rate_rad_per_s.mean,
            "creep_std_rad_per_s": joint.rate_rad_per_s.std,
            "jumps": sum(event.kind == "step-change" for event in joint.events),
        }
        if first is not None:
            after = {"days": first.after_s, "days_low": first.after_low_s, "days_high": first.after_high_s}
            out |= {name: None if s is None else s / day_s for name, s in after.items()}
            out |= {"limit": first.kind, "state": first.state}
        return out


def trend(types: Mapping[str, str], horizon_days: float = 365.0) -> Callable[[Any], Any]:
    """The trend of a tendon, for ``applyInArrow`` by robot and joint; the columns are ``TREND``.

    * ``types``: the folder of each robot type, by its name, with a path that is valid on every machine.
    * ``horizon_days``: forecast horizon from the last session.

    The input is all records of a tendon, in any order. The result is one row: offset, creep rate, the limit that is exceeded first
    and the days until then, with a 95 % interval. Records without a civil date or an offset are ignored.
    """
    follow = _Trend(types, horizon_days)
    # Spark looks at annotations to find out what a function takes; one without takes a table.
    return lambda table: follow(table)
