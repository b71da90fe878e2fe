"""Sinew: elongation of the rope tendons of a robot, estimated from its encoders.

    >>> import pysinew as sn
    >>> est = sn.estimate("monday.mcap", robot="robots/biorob-like")
    >>> print(est)                        # what the command prints
    >>> est.joint("elbow").offset_rad     # mean and deviation, rad
    >>> pandas.DataFrame.from_arrow(est.table())

Everything is in SI; a ± is a standard deviation. Errors are ``SinewError``, a ``ValueError``, and warnings ``SinewWarning``, with the
message of the command. Work runs without Python's lock, can be interrupted, and reports to ``progress``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import datasets as datasets
    from . import results as results
    from ._core import VERSION as __version__
    from ._core import Baseline as Baseline
    from ._core import Catalogue as Catalogue
    from ._core import OnlineEstimator as OnlineEstimator
    from ._core import OffsetObserver as OffsetObserver
    from ._core import Recording as Recording
    from ._core import Robot as Robot
    from ._core import RopeLaw as RopeLaw
    from ._core import Table as Table
    from ._creep import CreepFit as CreepFit
    from ._creep import CreepTests as CreepTests
    from ._errors import LocatedError as LocatedError
    from ._errors import RecordingWarning as RecordingWarning
    from ._errors import ResultWarning as ResultWarning
    from ._errors import RobotWarning as RobotWarning
    from ._errors import SinewError as SinewError
    from ._errors import SinewWarning as SinewWarning
    from ._errors import UnknownNameError as UnknownNameError
    from ._estimate import Estimate as Estimate
    from ._estimate import EstimateEach as EstimateEach
    from ._estimate import Learned as Learned
    from ._estimate import Merged as Merged
    from ._estimate import estimate as estimate
    from ._estimate import estimate_arrays as estimate_arrays
    from ._estimate import estimate_each as estimate_each
    from ._estimate import learn_baseline as learn_baseline
    from ._estimate import merge_baselines as merge_baselines
    from ._lerobot import lerobot as lerobot
    from ._live import Provisional as Provisional
    from ._look import check_robot as check_robot
    from ._look import recording_info as recording_info
    from ._plot import curves as curves
    from ._plot import plot as plot
    from ._rope import Guide as Guide
    from ._rope import describe_rope as describe_rope
    from ._rope import list_ropes as list_ropes
    from ._rope import plan_pretension as plan_pretension
    from ._rope import predict_rope as predict_rope
    from ._rope import select_rope as select_rope
    from ._simulate import Poses as Poses
    from ._simulate import Simulated as Simulated
    from ._simulate import propose_poses as propose_poses
    from ._simulate import scenario_text as scenario_text
    from ._simulate import simulate as simulate
    from ._trend import Trend as Trend
    from ._trend import trend as trend

# Module of each name, loaded on first use, so that `import pysinew` costs next to nothing.
_HOMES = {
    "_core": ("Baseline", "Catalogue", "OnlineEstimator", "OffsetObserver", "Recording", "Robot", "RopeLaw", "Table"),
    "_creep": ("CreepFit", "CreepTests"),
    "_errors": (
        "LocatedError",
        "RecordingWarning",
        "ResultWarning",
        "RobotWarning",
        "SinewError",
        "SinewWarning",
        "UnknownNameError",
    ),
    "_estimate": (
        "Estimate",
        "EstimateEach",
        "Learned",
        "Merged",
        "estimate",
        "estimate_arrays",
        "estimate_each",
        "learn_baseline",
        "merge_baselines",
    ),
    "_lerobot": ("lerobot",),
    "_live": ("Provisional",),
    "_look": ("check_robot", "recording_info"),
    "_plot": ("curves", "plot"),
    "_rope": ("Guide", "describe_rope", "list_ropes", "plan_pretension", "predict_rope", "select_rope"),
    "_simulate": ("Poses", "Simulated", "propose_poses", "scenario_text", "simulate"),
    "_trend": ("Trend", "trend"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Baseline",
    "Catalogue",
    "CreepFit",
    "CreepTests",
    "Estimate",
    "EstimateEach",
    "Guide",
    "Learned",
    "OnlineEstimator",
    "LocatedError",
    "Merged",
    "OffsetObserver",
    "Poses",
    "Provisional",
    "Recording",
    "RecordingWarning",
    "ResultWarning",
    "Robot",
    "RobotWarning",
    "RopeLaw",
    "Simulated",
    "SinewError",
    "SinewWarning",
    "Table",
    "Trend",
    "UnknownNameError",
    "__version__",
    "check_robot",
    "curves",
    "datasets",
    "describe_rope",
    "estimate",
    "estimate_arrays",
    "estimate_each",
    "learn_baseline",
    "lerobot",
    "list_ropes",
    "merge_baselines",
    "plan_pretension",
    "plot",
    "predict_rope",
    "propose_poses",
    "recording_info",
    "results",
    "scenario_text",
    "select_rope",
    "simulate",
    "trend",
]


def __getattr__(name: str) -> Any:
    import importlib

    if name == "__version__":
        value: Any = importlib.import_module("._core", __name__).VERSION
    elif name in ("datasets", "results"):
        value = importlib.import_module("." + name, __name__)
    elif name in _HOME_OF:
        value = getattr(importlib.import_module("." + _HOME_OF[name], __name__), name)
    else:
        raise AttributeError(f"module 'pysinew' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
