"""Months of sessions."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

from . import results
from ._answer import Answer
from ._core import trend as _trend
from ._estimate import Estimate
from ._types import PathLike, Progress

if TYPE_CHECKING:
    from ._types import RobotLike

Dates = Union[str, "Sequence[str]", "Mapping[str, str | Sequence[str]]"]
"""A day, several, or those of each joint by its name."""


class Trend(Answer, results.TrendResult):
    """Each tendon's state, its events, and the day it will pass its limits.

    Tables: ``sessions`` (every session, mrad), ``series`` (levels and forecast over time, rad).
    """

    __slots__ = ()

    def joint(self, name: str) -> results.JointTrend:
        """The trend of a joint. Raises ``KeyError`` where there is none."""
        for joint in self.joints:
            if joint.name == name:
                return joint
        raise KeyError(f"no joint '{name}'; there are {', '.join(joint.name for joint in self.joints)}")


def _dates(stated: Dates) -> list[tuple[str | None, str]]:
    if isinstance(stated, str):
        return [(None, stated)]
    if isinstance(stated, Mapping):
        pairs = []
        for joint, days in stated.items():
            pairs += [(joint, day) for day in ([days] if isinstance(days, str) else days)]
        return [(joint, day) for joint, day in pairs]
    return [(None, day) for day in stated]


def _text(table: Any, name: str) -> tuple[str, str, str]:
    """A table as CSV: a data frame, columns by name, or rows."""
    if hasattr(table, "to_csv"):
        return "csv", name, table.to_csv(index=False)
    if hasattr(table, "write_csv"):
        return "csv", name, table.write_csv()
    if isinstance(table, Mapping):
        heads = list(table)
        rows = list(zip(*(list(column) for column in table.values())))
    else:
        heads = list(dict.fromkeys(key for row in table for key in row))
        rows = [tuple(row.get(head) for head in heads) for row in table]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([["" if cell is None or cell != cell else cell for cell in row] for row in rows])
    return "csv", name, out.getvalue()


def trend(
    records: Any,
    robot: RobotLike | None = None,
    *,
    tensioned: Dates = (),
    replaced: Dates = (),
    duty: PathLike | None = None,
    ropes: Sequence[PathLike] = (),
    horizon_days: float = 1095.0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Trend:
    """Evaluates the trend of tendons over months: offsets, events, and dates of re-tensioning or replacement.

    * ``records``: answers of ``estimate``, files (JSON or CSV), or both in a list; or a table (a data frame, columns by
      name, rows) with ``time``, ``joint``, ``offset_mrad``, ``interval_95_mrad`` and, optionally, ``temperature_c``,
      ``robot``, ``baseline``, ``duration_s``.
    * ``robot``: folder of the robot or a ``Robot``: ropes, geometry, limits. Without it, angles only.
    * ``tensioned``, ``replaced``: days, of all tendons or by joint.
    * ``duty``: duty file of the ropes; ``ropes``: folders with additional ropes.
    * ``horizon_days``: forecast horizon from the last session.

    Raises ``ValueError`` with the sentence of the command.
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
        _trend(sources, robot, _dates(tensioned), _dates(replaced), duty, list(ropes), horizon_days, seed, progress)
    )
