"""Types that signatures share."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Sequence, Union

if TYPE_CHECKING:
    import datetime
    from typing import IO

    import numpy as np
    import numpy.typing as npt

    from ._core import Baseline, Recording, Robot

    ArrayLike = npt.ArrayLike
    AnyArray = npt.NDArray[Any]
    RecordingLike = Union[str, os.PathLike[str], bytes, IO[bytes], IO[str], Recording]
    DateLike = Union[str, datetime.date, np.datetime64]
    RandomLike = Union[int, np.random.Generator]
    RobotLike = Union[str, os.PathLike[str], Robot]
    BaselineLike = Union[str, os.PathLike[str], Baseline]

PathLike = Union[str, "os.PathLike[str]"]
Stated = Union[float, "tuple[float, float]"]
"""A number, or its mean and standard deviation."""
Progress = Callable[[float, str], object]
"""Called now and then with the share of the work done, 0 to 1, and what is being done."""
Injection = Union["tuple[str, float]", "tuple[str, float, float | None]"]
"""Joint, offset in rad, and from which time on, s."""


def seed_of(seed: int, rng: RandomLike | None) -> int:
    """The seed of a function: ``rng``, a number drawn from it if it is a generator of NumPy; without it, ``seed``."""
    if rng is None:
        return seed
    return int(rng.integers(2**63)) if hasattr(rng, "integers") else int(rng)


def injections(inject: Sequence[Injection]) -> list[tuple[str, float, float | None]]:
    """Each with its time, or none."""
    return [(item[0], item[1], item[2] if len(item) > 2 else None) for item in inject]
