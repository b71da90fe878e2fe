"""Types that signatures share."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Sequence, Union

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._core import Baseline, Recording, Robot

    ArrayLike = npt.ArrayLike
    AnyArray = npt.NDArray[Any]
    RecordingLike = Union[str, os.PathLike[str], Recording]
    RobotLike = Union[str, os.PathLike[str], Robot]
    BaselineLike = Union[str, os.PathLike[str], Baseline]

PathLike = Union[str, "os.PathLike[str]"]
Stated = Union[float, "tuple[float, float]"]
"""A number, or its mean and standard deviation."""
Progress = Callable[[float, str], object]
"""Called now and then with the share of the work done, 0 to 1, and what is being done."""
Injection = Union["tuple[str, float]", "tuple[str, float, float | None]"]
"""Joint, offset in rad, and from which time on, s."""


def injections(inject: Sequence[Injection]) -> list[tuple[str, float, float | None]]:
    """Each with its time, or none."""
    return [(item[0], item[1], item[2] if len(item) > 2 else None) for item in inject]
