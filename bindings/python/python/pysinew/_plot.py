"""Figures of results with matplotlib or plotly, which are required for no other function."""

from __future__ import annotations

import importlib.util
import sys
from typing import TYPE_CHECKING, Any, Callable, Literal, NamedTuple

from ._answer import Answer
from ._core import Z95
from ._creep import CreepAnalysis, CreepFit
from ._estimate import Estimate
from ._rope import Prediction, Selection
from ._trend import Trend

if TYPE_CHECKING:
    from ._types import AnyArray

Backend = Literal["matplotlib", "plotly"]
_BACKENDS: tuple[Backend, ...] = ("matplotlib", "plotly")


class Curve(NamedTuple):
    """A curve, with its 95 % band where it has one."""

    name: str
    x: AnyArray
    y: AnyArray
    low: AnyArray | None = None
    high: AnyArray | None = None
    marks: bool = False
    """Points instead of a line; their intervals are bars."""
    labels: list[str] | None = None


class Curves(NamedTuple):
    """Content of a figure, independent of the renderer."""

    x: str
    """What the axis across says, with its unit."""
    y: str
    curves: list[Curve]
    is_logarithmic: bool = False
    """Whether the axis across is."""


def curves(answer: Answer) -> Curves:
    """The main curves of a result, for a custom figure.

    Parameters
    ----------
    answer
        A result with curves over time, or of ropes.

    Returns
    -------
    Curves
        Axis titles, and the curves with their 95 % bands.

    Raises
    ------
    TypeError
        Where the result has none.
    """
    for kind, make in _MAKERS.items():
        if isinstance(answer, kind):
            return make(answer)
    shown = ", ".join(kind.__name__ for kind in _MAKERS)
    raise TypeError(f"{type(answer).__name__} has no curves; these have: {shown}")


def plot(answer: Answer, *, backend: Backend | None = None, ax: Any = None) -> Any:
    """Plots the main curves of a result, with 95 % bands.

    Parameters
    ----------
    answer
        A result with curves, as ``curves`` takes it.
    backend
        ``"matplotlib"`` or ``"plotly"``; the default is the one that is already imported, otherwise the
        installed one.
    ax
        Axes of matplotlib to draw into.

    Returns
    -------
    matplotlib.axes.Axes or plotly.graph_objects.Figure
        The figure; its legend names every curve.

    Raises
    ------
    ImportError
        Where neither is installed.
    TypeError
        Where the result has no curves.
    """
    shown = curves(answer)
    chosen = "matplotlib" if ax is not None else backend or _backend()
    return _matplotlib(shown, ax) if chosen == "matplotlib" else _plotly(shown)


def _backend() -> Backend:
    for name in _BACKENDS:
        if name in sys.modules:
            return name
    for name in _BACKENDS:
        if importlib.util.find_spec(name) is not None:
            return name
    raise ImportError("neither matplotlib nor plotly is installed; pip install one of them")


def _matplotlib(shown: Curves, ax: Any) -> Any:
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=(8, 4), layout="constrained")
    for curve in shown.curves:
        if curve.marks:
            bars = None if curve.low is None else [curve.y - curve.low, curve.high - curve.y]
            ax.errorbar(curve.x, curve.y, yerr=bars, fmt="o", markersize=4, label=curve.name)
            for x, y, label in zip(curve.x, curve.y, curve.labels or []):
                ax.annotate(label, (x, y), xytext=(4, 4), textcoords="offset points", fontsize="small")
            continue
        (line,) = ax.plot(curve.x, curve.y, label=curve.name)
        if curve.low is not None:
            ax.fill_between(curve.x, curve.low, curve.high, color=line.get_color(), alpha=0.2, linewidth=0)
    if shown.is_logarithmic:
        ax.set_xscale("log")
    ax.set_xlabel(shown.x)
    ax.set_ylabel(shown.y)
    if len(shown.curves) > 1:
        ax.legend()
    return ax


def _plotly(shown: Curves) -> Any:
    import plotly.graph_objects as go
    from plotly.colors import qualitative

    figure = go.Figure()
    for i, curve in enumerate(shown.curves):
        colour = qualitative.D3[i % len(qualitative.D3)]
        marker = {"color": colour}
        if curve.marks:
            bars = None
            if curve.low is not None:
                bars = {"array": curve.high - curve.y, "arrayminus": curve.y - curve.low}
            figure.add_scatter(
                x=curve.x,
                y=curve.y,
                error_y=bars,
                mode="markers+text" if curve.labels else "markers",
                text=curve.labels,
                textposition="top right",
                name=curve.name,
                marker=marker,
            )
            continue
        if curve.low is not None:
            for edge, fill in ((curve.low, None), (curve.high, "tonexty")):
                figure.add_scatter(
                    x=curve.x,
                    y=edge,
                    mode="lines",
                    line={"width": 0, "color": colour},
                    fill=fill,
                    opacity=0.2,
                    showlegend=False,
                    hoverinfo="skip",
                    legendgroup=curve.name,
                )
        figure.add_scatter(x=curve.x, y=curve.y, mode="lines", name=curve.name, line=marker, legendgroup=curve.name)
    figure.update_layout(xaxis_title=shown.x, yaxis_title=shown.y)
    if shown.is_logarithmic:
        figure.update_xaxes(type="log")
    return figure


def _words(column: list[str | None]) -> AnyArray:
    import numpy as np

    return np.array(column, dtype=object)


def _of_estimate(answer: Estimate) -> Curves:
    table = answer.table("series")
    method, joints = _words(table["method"]), _words(table["joint"])
    time_s, offset, half = table["time_s"], 1e3 * table["offset_rad"], 1e3 * Z95 * table["offset_std_rad"]
    out = []
    for joint in dict.fromkeys(joints):
        rows = (method == answer.method) & (joints == joint)
        band = answer.method == "absolute"
        low, high = (offset - half)[rows], (offset + half)[rows]
        out.append(Curve(joint, time_s[rows], offset[rows], low if band else None, high if band else None))
    return Curves("time (s)", "offset (mrad)", out)


def _of_trend(answer: Trend) -> Curves:
    table = answer.table("series")
    kinds, joints = _words(table["kind"]), _words(table["joint"])
    days = table["time_s"] / 86_400.0
    out = []
    for joint in dict.fromkeys(joints):
        for kind, name in (("session", joint), ("forecast", f"{joint}, forecast")):
            rows = (kinds == kind) & (joints == joint)
            if rows.any():
                level, low, high = (1e3 * table[c][rows] for c in ("tracked_rad", "tracked_low_rad", "tracked_high_rad"))
                out.append(Curve(name, days[rows], level, low, high))
    return Curves("days since the first session", "offset (mrad)", out)


def _of_prediction(answer: Prediction) -> Curves:
    table = answer.table("series")
    parts = (1e3 * table[f"since_tensioned{part}_m"] for part in ("", "_low", "_high"))
    mean, low, high = parts
    return Curves("time (s)", "elongation since tensioned (mm)", [Curve(answer.rope, table["time_s"], mean, low, high)], True)


def _of_selection(answer: Selection) -> Curves:
    import numpy as np

    known = [c for c in answer.candidates if c.diameter_m is not None]
    diameter = np.array([1e3 * (c.diameter_m or np.nan) for c in known])
    value, low, high = (
        np.array([1e3 * getattr(c.elongation_m, part) for c in known]) for part in ("value", "low", "high")
    )
    points = Curve("ropes", diameter, value, low, high, True, [c.rope for c in known])
    return Curves("diameter (mm)", "elongation (mm)", [points])


def _of_creep(answer: CreepAnalysis | CreepFit) -> Curves:
    table = answer.table("series")
    is_fit = isinstance(answer, CreepFit)
    names = _words(table["name" if is_fit else "specimen"])
    kinds = _words(table["kind"] if is_fit else ["reading"] * len(names))
    time_s, strain = table["time_s"], 100.0 * table["strain_ratio"]
    out = []
    for name in dict.fromkeys(names):
        for kind in ("reading", "forecast"):
            rows = (names == name) & (kinds == kind) & (time_s > 0.0)
            if not rows.any():
                continue
            if kind == "reading":
                out.append(Curve(name, time_s[rows], strain[rows]))
            else:
                low, high = (100.0 * table[c][rows] for c in ("reading_low_ratio", "reading_high_ratio"))
                out.append(Curve(f"{name}, forecast", time_s[rows], strain[rows], low, high))
    return Curves("time (s)", "strain (%)", out, True)


_MAKERS: dict[type[Answer], Callable[[Any], Curves]] = {
    Estimate: _of_estimate,
    Trend: _of_trend,
    Prediction: _of_prediction,
    Selection: _of_selection,
    CreepAnalysis: _of_creep,
    CreepFit: _of_creep,
}
