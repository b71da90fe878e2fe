"""Months of sessions."""

from __future__ import annotations

import csv
import datetime
import io
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Sequence, Union

from . import results
from ._answer import Answer
from ._core import Z95
from ._core import trend as _trend
from ._errors import UnknownNameError
from ._estimate import Estimate
from ._frames import day
from ._types import PathLike, Progress, seed_of

if TYPE_CHECKING:
    from ._types import DateLike, RandomLike, RobotLike

DAY_S = 86_400.0
Dates = Union["DateLike", "Sequence[DateLike]", "Mapping[str, DateLike | Sequence[DateLike]]"]
"""A day, several, or those of each joint by its name."""


class Trend(Answer, results.TrendResult):
    """Each tendon's state, its events, and the day it will pass its limits.

    Tables: ``sessions`` (every session), ``series`` (tracked offset and forecast over time).
    """

    __slots__ = ()

    def joint(self, name: str) -> results.JointTrend:
        """The trend of a joint.

        Parameters
        ----------
        name
            Name of the joint.

        Returns
        -------
        results.JointTrend
            Its state, events and forecast.

        Raises
        ------
        UnknownNameError
            Where there is no such joint.
        """
        for joint in self.joints:
            if joint.name == name:
                return joint
        raise UnknownNameError(f"no joint '{name}'; there are {', '.join(joint.name for joint in self.joints)}")


def _dates(stated: Dates) -> list[tuple[str | None, str]]:
    def days(own: Any) -> list[str]:
        is_several = isinstance(own, Iterable) and not isinstance(own, str)
        return [day(one) for one in own] if is_several else [day(own)]

    if isinstance(stated, Mapping):
        return [(joint, one) for joint, own in stated.items() for one in days(own)]
    return [(None, one) for one in days(stated)]


# Columns of the tables of `estimate` under the names and in the units of session records.
_RECORDED = {"time_utc_s": ("time", 1.0), "offset_rad": ("offset_mrad", 1e3), "offset_std_rad": ("interval_95_mrad", 1e3 * Z95)}


def _recorded(columns: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Columns of a table, with those of ``estimate`` as session records have them."""
    out = {}
    for head, column in columns.items():
        name, factor = _RECORDED.get(head, (head, 1.0))
        cells = column.to_pylist() if hasattr(column, "to_pylist") else list(column)
        if head in _RECORDED:
            # Empty where the value is not known.
            cells = [None if cell is None or cell != cell else factor * cell for cell in cells]
        out[name] = cells
    return out


def _cell(cell: Any) -> Any:
    if cell is None or cell != cell:
        return ""
    # NumPy's numbers as Python's: the shortest text that reads back as the same number.
    cell = cell.item() if hasattr(cell, "item") and not hasattr(cell, "isoformat") else cell
    return day(cell) if isinstance(cell, datetime.date) else cell


def _text(table: Any, name: str) -> tuple[str, str, str]:
    """A table as CSV: a data frame, columns by name, or rows."""
    names = getattr(table, "column_names", None)
    if names is None and hasattr(table, "columns"):
        names = list(table.columns)
    if names is not None or isinstance(table, Mapping):
        columns = _recorded({head: table[head] for head in (table if names is None else names)})
        heads = list(columns)
        rows = list(zip(*columns.values()))
    else:
        heads = list(dict.fromkeys(key for row in table for key in row))
        rows = [tuple(row.get(head) for head in heads) for row in table]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([[_cell(cell) for cell in row] for row in rows])
    return "csv", name, out.getvalue()


def trend(
    records: Any,
    robot: RobotLike | None = None,
    *,
    tensioned: Dates = (),
    replaced: Dates = (),
    duty: PathLike | None = None,
    ropes: Sequence[PathLike] = (),
    horizon_s: float = 1095.0 * DAY_S,
    seed: int = 1,
    rng: RandomLike | None = None,
    progress: Progress | None = None,
) -> Trend:
    """Evaluates the trend of tendons over months: offsets, events, and dates of re-tensioning or replacement.

    Parameters
    ----------
    records
        Answers of ``estimate``, their tables, files (JSON or CSV), or these in a list; or a table (a data
        frame, columns by name, rows) with ``time``, ``joint``, ``offset_mrad``, ``interval_95_mrad`` and,
        optionally, ``temperature_c``, ``robot``, ``baseline``, ``duration_s``.
    robot
        Folder of the robot or a ``Robot``: ropes, geometry, limits. Without it, angles only.
    tensioned, replaced
        Days or times as text or ``datetime``, of all tendons or by joint.
    duty
        Duty file of the ropes.
    ropes
        Folders with additional ropes.
    horizon_s
        Forecast horizon from the last session, s.
    seed
        Seed of the forecast draws.
    rng
        Seed or generator of NumPy, instead of ``seed``.
    progress
        Called with the completed share and the step.

    Returns
    -------
    Trend
        State, events and forecast of each tendon.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    sources: list[Any] = []
    is_list = isinstance(records, (list, tuple))
    items = list(records) if is_list else [records]
    if is_list and items and all(isinstance(item, Mapping) for item in items):
        items = [items]
    for i, item in enumerate(items):
        if isinstance(item, Estimate):
            sources.append(("json", f"records[{i}]", item.to_json()))
        elif isinstance(item, str) or hasattr(item, "__fspath__"):
            sources.append(item)
        else:
            sources.append(_text(item, "records"))
    return Trend(
        _trend(sources, robot, _dates(tensioned), _dates(replaced), duty, list(ropes), horizon_s, seed_of(seed, rng), progress)
    )
