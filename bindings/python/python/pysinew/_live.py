"""Result types of the online estimator."""

from __future__ import annotations

from typing import Literal

from ._record import Record


class Provisional(Record):
    """Reason for a provisional offset: its interval is wide, or may still change by more than it states."""

    __slots__ = ()

    reason: Literal["starting", "step", "change-near-end", "rejected", "not-solved"]
    """``"starting"``: no window has been solved yet. ``"step"``: a step of this offset explains the newest blocks; the
    interval is the hull of both hypotheses. ``"change-near-end"``: the window contains a change so late that it may be a
    contact that has not ended. ``"rejected"``: too many blocks are rejected as outliers. ``"not-solved"``: the window could
    not be solved, and the estimate is the one before.
    """
    since_s: float | None
    """Likeliest time of the step or time of the change, s since the first sample; ``None`` for other reasons."""
    probability: float | None
    """Posterior probability of the step, 0 to 1; ``None`` for other reasons."""
    share: float | None
    """Share of the window's blocks that is rejected, 0 to 1; ``None`` for other reasons."""

    _fields = {
        "reason": "",
        "since_s": "",
        "probability": "",
        "share": "",
    }
