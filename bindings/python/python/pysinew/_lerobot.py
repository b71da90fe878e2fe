"""Episodes of LeRobot data sets as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

from ._errors import SinewError

if TYPE_CHECKING:
    from ._types import AnyArray


def lerobot(
    dataset: Any,
    *,
    q: str,
    theta: str,
    episode: int | None = None,
    joints: Sequence[str] | None = None,
    tau_m: str | None = None,
    dq: str | None = None,
    tau_el: str | None = None,
    scale: float = 1.0,
) -> dict[str, Any]:
    """The columns of an episode as ``estimate_arrays`` takes them: ``estimate_arrays(robot, **lerobot(ds, ...))``.

    Parameters
    ----------
    dataset
        A ``LeRobotDataset``, a data set of the package ``datasets``, or a table of pyarrow, pandas or
        polars with its columns. A folder or a file is opened with ``Recording`` instead.
    q, theta
        The features with joint and motor positions, such as ``"observation.state"``.
    tau_m, dq, tau_el
        The features with motor torques, joint velocities and elastic torques.
    episode
        Which ``episode_index``; needed where there is more than one.
    joints
        Names of the columns; the default is the names of the data set, otherwise those of the robot.
    scale
        Factor from the data set's angles to rad (π/180 where they are degrees).

    Returns
    -------
    dict
        Arguments of ``estimate_arrays``.

    Raises
    ------
    SinewError
        Where there is no such feature or episode.
    """
    import numpy as np

    names = _names(dataset, q) if joints is None else list(joints)
    columns = _columns(dataset)

    def find(feature: str) -> Any:
        if feature not in columns:
            raise SinewError(f"no feature '{feature}' in the data set; it has {', '.join(map(str, columns))}")
        return columns[feature]

    episodes = _plain(find("episode_index")) if "episode_index" in columns else None
    if episodes is None:
        rows: Any = slice(None)
    else:
        there = np.unique(episodes)
        if episode is None and len(there) > 1:
            raise SinewError(f"the data set has {len(there)} episodes, from {there[0]} to {there[-1]}; name one with episode")
        wanted = there[0] if episode is None else episode
        rows = np.flatnonzero(episodes == wanted)
        if len(rows) == 0:
            raise SinewError(f"no episode {wanted}; there are {len(there)}, from {there[0]} to {there[-1]}")

    def matrix(feature: str, factor: float) -> AnyArray:
        values = _plain(find(feature))[rows]
        if values.ndim != 2:
            raise SinewError(f"feature '{feature}' must hold a list of numbers per frame, one per joint")
        return np.asarray(values, dtype=np.float64) * factor if factor != 1.0 else np.asarray(values, dtype=np.float64)

    out: dict[str, Any] = {
        "time_s": np.asarray(_plain(find("timestamp"))[rows], dtype=np.float64),
        "q": matrix(q, scale),
        "theta": matrix(theta, scale),
    }
    if dq is not None:
        out["dq"] = matrix(dq, scale)
    for key, feature in (("tau_m", tau_m), ("tau_el", tau_el)):
        if feature is not None:
            out[key] = matrix(feature, 1.0)
    if names is not None:
        out["joints"] = names
    return out


def _columns(dataset: Any) -> Any:
    """Returns an object that provides the column names, and a column by its name."""
    table = getattr(dataset, "hf_dataset", dataset)
    if hasattr(table, "with_format") and hasattr(table, "column_names"):
        # A data set of the package `datasets`: without the transforms that make tensors one by one.
        return _Hugging(table.with_format("numpy"))
    if hasattr(table, "column_names") and hasattr(table, "column"):
        return {name: table.column(name) for name in table.column_names}
    return table


class _Hugging:
    def __init__(self, table: Any) -> None:
        self._table = table

    def __contains__(self, name: str) -> bool:
        return name in self._table.column_names

    def __iter__(self) -> Any:
        return iter(self._table.column_names)

    def __getitem__(self, name: str) -> Any:
        return self._table[name][:]


def _plain(column: Any) -> AnyArray:
    """A column as numbers; lists per row become a second axis."""
    import numpy as np

    if hasattr(column, "to_pylist"):
        column = column.to_pylist()
    elif hasattr(column, "to_list"):
        column = column.to_list()
    return np.asarray(column)


def _names(dataset: Any, feature: str) -> list[str] | None:
    """Names of a feature's elements, where the data set states them."""
    features = getattr(dataset, "features", None)
    stated = features.get(feature) if isinstance(features, dict) else None
    names = stated.get("names") if isinstance(stated, dict) else None
    if isinstance(names, dict):
        names = next(iter(names.values()), None)
    if not names:
        return None
    # Drivers of LeRobot append the quantity: `elbow.pos`.
    return [str(name).removesuffix(".pos") for name in names]
