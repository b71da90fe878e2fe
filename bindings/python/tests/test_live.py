"""Sample by sample: what a control loop would see."""

from __future__ import annotations

import ast
import inspect
import threading
import time
from pathlib import Path
from typing import Any, Callable, Iterator

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT


def samples(work: Path, from_s: float, to_s: float) -> Iterator[tuple[float, tuple[Any, ...]]]:
    """Samples as ``step`` takes them, each after its time since the start of the recording."""
    arrays = sn.Recording(work).arrays(joints=sn.Robot(ROBOT).joints)
    time_s = (arrays["time_ns"] - arrays["time_ns"][0]) * 1e-9
    rows = np.flatnonzero((time_s >= from_s) & (time_s < to_s))
    dt = np.diff(arrays["time_ns"][rows], prepend=arrays["time_ns"][rows][0]) * 1e-9
    celsius = arrays.get("temperature_c", np.full(len(time_s), np.nan))
    for i, row in enumerate(rows):
        sample = (arrays["q"][row], arrays["theta"][row], arrays["tau_m"][row], float(celsius[row]))
        yield float(time_s[row]), (float(dt[i]), *sample)


def drive(live: sn.OnlineEstimator, work: Path, to_s: float, each: Callable[[float], object] = lambda _: None) -> int:
    """Steps from 60 s on, solving after every block; how many blocks there were."""
    blocks = 0
    for now_s, sample in samples(work, 60.0, to_s):
        if live.step(*sample) == "block":
            blocks += 1
            live.work()
            each(now_s)
    return blocks


def test_live_offsets_are_those_of_the_recording_so_far(work: Path, learned: sn.Learned) -> None:
    robot = sn.Robot(ROBOT)
    live = sn.OnlineEstimator(robot, learned.learned_baseline)
    assert live.is_provisional and live.result() is None and live.error is None
    assert np.isnan([live.time_s, live.solved_s, live.age_s, *live.offset("elbow")]).all()
    assert {live.provisional(joint).reason for joint in robot.joints} == {"starting"}
    assert live.provisional("elbow").since_s is None and live.provisional("elbow").probability is None
    with pytest.raises(sn.SinewError, match="^early: an offset is provisional"):
        live.save("early", 0)

    ages_s: list[float] = []
    solved_at_s: list[float] = []

    def each(now_s: float) -> None:
        assert (live.blocks_behind, live.blocks_dropped) == (0, 0)
        if not np.isnan(live.solved_s):
            ages_s.append(live.age_s)
            if live.age_s == 0.0:
                solved_at_s.append(now_s)

    # Five blocks a second, once the filters have settled.
    blocks = drive(live, work, 120.0, each)
    assert 250 < blocks < 300, blocks
    assert len(solved_at_s) == blocks // 10 and max(ages_s) < 2.0
    assert live.error is None

    # As of the last solution: the estimate of a recording that ends there.
    batch = sn.estimate(
        work, robot, baseline=learned.learned_baseline, from_s=60.0, to_s=solved_at_s[-1] + 1e-4
    ).session
    now = live.result()
    assert batch is not None and isinstance(now, sn.results.SessionEstimate) and type(now) is type(batch)
    assert [joint.name for joint in now.joints] == robot.joints
    means, deviations = live.offsets()
    for i, (own, wanted) in enumerate(zip(now.joints, batch.joints)):
        # Times of blocks are rounded on another clock.
        assert abs(own.offset_rad.mean - wanted.offset_rad.mean) < 1e-9, own.name
        assert abs(own.offset_rad.std - wanted.offset_rad.std) < 1e-9, own.name
        assert (own.verdict, len(own.changes)) == (wanted.verdict, len(wanted.changes))
        assert live.offset(own.name) == (means[i], deviations[i])
        if live.provisional(own.name) is None:
            assert live.offset(own.name) == (own.offset_rad.mean, own.offset_rad.std)
        changed = live.stiffness_changed_probability(own.name)
        assert changed is None or 0.0 <= changed <= 1.0
    # Unknown where the recording holds no temperature, and nowhere else.
    is_recorded = "temperature_c" in sn.Recording(work).arrays()
    unknown_rad = live.unknown_temperature_rad
    assert unknown_rad.shape == (len(robot.joints),) and (unknown_rad <= deviations).all()
    assert (unknown_rad > 0.0).any() != is_recorded
    assert 0.0 <= live.contact_probability <= 1.0
    assert (live.external_force is None) == (batch.external_force is None)
    if live.external_force is not None:
        probability, force_n, std_n = live.external_force
        assert 0.0 <= probability < 0.3, "nothing pulls"
        assert force_n.shape == std_n.shape == (3,) and (std_n > 0.0).all()


def test_a_session_is_saved_where_no_offset_is_provisional(work: Path, learned: sn.Learned) -> None:
    live = sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    saved: list[sn.Baseline] = []
    reasons: set[str] = set()

    def each(now_s: float) -> None:
        whys = [live.provisional(joint) for joint in live.joints]
        assert live.is_provisional == any(whys)
        for why in filter(None, whys):
            reasons.add(why.reason)
            assert (why.reason == "step") == (why.probability is not None)
            assert (why.since_s is not None) == (why.reason in ("step", "change-near-end"))
            assert type(why)(why.to_dict()) == why
        if live.is_provisional:
            with pytest.raises(sn.SinewError, match="^session: an offset is provisional"):
                live.save("session", 0)
        else:
            saved.append(live.save("session", int(now_s * 1e9)))

    drive(live, work, 80.0, each)
    assert "starting" in reasons and saved
    assert saved[-1].recordings[-1] == "session" and len(saved[-1].recordings) == 2
    sn.OnlineEstimator(ROBOT, saved[-1])


def test_the_online_estimate_is_replayed_over_a_recording(work: Path, learned: sn.Learned) -> None:
    method = {"baseline": learned.learned_baseline, "from_s": 60.0, "to_s": 120.0}
    answer = sn.estimate(work, ROBOT, **method, online=True)
    assert answer.session is not None and answer.session.online is not None
    online = answer.session.online
    assert [joint.name for joint in online.joints] == [joint.name for joint in answer.session.joints]
    assert online.provisional_intervals[0].to_s > online.provisional_intervals[0].from_s
    plain = sn.estimate(work, ROBOT, **method)
    assert plain.session is not None and plain.session.online is None
    with pytest.raises(ValueError, match="online applies to the absolute estimate only"):
        sn.estimate(work, ROBOT, method="paper", online=True)


def test_what_is_stated_of_a_running_robot(work: Path, learned: sn.Learned) -> None:
    force_n = ((0.0, 0.0, 0.0), 0.1)
    stated = sn.OnlineEstimator(ROBOT, learned.learned_baseline, external_force_n=force_n, empty=True, creep=False)
    drive(stated, work, 120.0)
    assert stated.external_force is not None and stated.external_force[0] == 1.0
    with pytest.raises(ValueError, match="mutually exclusive"):
        sn.OnlineEstimator(ROBOT, learned.learned_baseline, empty=True, payload_kg=1.0)
    with pytest.raises(ValueError, match="not_there"):
        sn.OnlineEstimator(ROBOT, "not_there.baseline")


def test_online_without_baseline_uses_encoder_zero(work: Path, learned: sn.Learned) -> None:
    fresh, since = sn.OnlineEstimator(ROBOT), sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    for live in (fresh, since):
        drive(live, work, 70.0)
    assert fresh.result().baseline is None and since.result().baseline is not None
    assert fresh.offset("elbow")[1] > since.offset("elbow")[1]


@pytest.mark.parametrize("inside", [True, False])
def test_a_thread_solves(work: Path, learned: sn.Learned, inside: bool) -> None:
    live = sn.OnlineEstimator(ROBOT, learned.learned_baseline, worker=inside)
    ends = threading.Event()

    def solve() -> None:
        while not ends.wait(0.01):
            live.work()

    thread = threading.Thread(target=solve)
    if not inside:
        thread.start()
    patience = time.monotonic() + 60.0

    def wait(most: int) -> None:
        while live.blocks_behind > most:
            assert time.monotonic() < patience, "no answer"
            time.sleep(0.01)

    try:
        # As fast as the worker takes blocks, which is faster than a robot makes them.
        for _, sample in samples(work, 60.0, 66.0):
            if live.step(*sample) == "block":
                wait(3)
        wait(0)
    finally:
        ends.set()
        if not inside:
            thread.join()
    assert live.blocks_dropped == 0 and np.isfinite(live.offsets()).all()
    assert isinstance(live.result(), sn.results.SessionEstimate)


def test_late_worker_drops_blocks_and_continues(work: Path, learned: sn.Learned) -> None:
    live = sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    for now_s, sample in samples(work, 60.0, 90.0):
        if live.step(*sample) == "block" and now_s > 85.0:
            live.work()
    assert live.blocks_dropped > 0 and live.blocks_behind == 0
    assert np.isfinite(live.offset("elbow")).all() and live.error is None


def test_stubs_match_docstrings() -> None:
    stub = Path(sn.__file__).parent / "_core.pyi"
    classes = [node for node in ast.parse(stub.read_text("utf-8")).body if isinstance(node, ast.ClassDef)]
    own = next(node for node in classes if node.name == "OnlineEstimator")
    assert ast.get_docstring(own) == inspect.getdoc(sn.OnlineEstimator)
    for member in own.body:
        if isinstance(member, ast.FunctionDef) and member.name != "__new__":
            assert ast.get_docstring(member) == inspect.getdoc(getattr(sn.OnlineEstimator, member.name)), member.name


def test_a_baseline_is_a_text(learned: sn.Learned) -> None:
    text = learned.learned_baseline.to_text()
    again = sn.Baseline.from_text(text)
    assert again.to_text() == text and again.joints == learned.learned_baseline.joints
    with pytest.raises(ValueError, match="mine: not a baseline"):
        sn.Baseline.from_text("{}", name="mine")


def test_samples_that_can_not_be_used_change_nothing(learned: sn.Learned) -> None:
    live = sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    q = [0.1, 0.2, 0.3, 0.4]
    assert live.step(0.0, q, q) == "restarted"
    assert live.step(0.002, q, q) == "accepted"
    assert live.step(0.002, [0.1, float("nan"), 0.3, 0.4], q).startswith("rejected: a joint position")
    assert live.step(0.002, q, [float("nan")] * 4).startswith("rejected: a motor position")
    for wrong in (0.0, -1.0, float("nan"), 1e10):
        with pytest.raises(ValueError, match="time step"):
            live.step(wrong, q, q)
    with pytest.raises(ValueError, match="one entry per joint"):
        live.step(0.002, q[:3], q)
    assert live.step(0.002, q, q) == "accepted"
    live.interrupt()
    assert live.step(0.002, q, q) == "restarted"
    for method in (live.offset, live.provisional, live.stiffness_changed_probability):
        with pytest.raises(ValueError, match="joints are shoulder_yaw"):
            method("hip")


def test_the_observer_finds_a_longer_rope() -> None:
    observer = sn.OffsetObserver(ROBOT)
    q, theta = np.zeros(4), np.array([0.0, 0.0, 0.010, 0.0])
    # The arm hangs still; the elbow's rope is 10 mrad longer than the encoders know.
    for _ in range(1000):
        observer.step(1e-3, q, theta)
    assert observer.is_settled and observer.settling_time_s < 1.0
    assert observer.delta_e[2] == pytest.approx(0.010, abs=1e-12)
    assert sn.Robot(ROBOT).elongation_m("elbow", observer.delta_e[2]) == pytest.approx(0.25e-3, abs=1e-12)
    observer.reset()
    assert not observer.is_settled


def test_momentum_is_half_of_twice_the_kinetic_energy() -> None:
    robot = sn.Robot(ROBOT)
    rng = np.random.default_rng(1)
    q, dq = rng.normal(size=(2, 7, 3, 4))
    p, ct_dq, g = robot.momentum(q, dq)
    assert p.shape == ct_dq.shape == g.shape == q.shape
    # p = M(q) dq is linear in dq; g does not depend on it.
    twice, _, same = robot.momentum(q, 2.0 * dq)
    assert np.allclose(twice, 2.0 * p, rtol=1e-13) and (same == g).all()
    assert ((p * dq).sum(axis=-1) > 0.0).all()
    # Cᵀ dq = ∂T/∂q, T = ½ p·dq.
    h = 1e-6
    for joint in range(4):
        shift = h * np.eye(4)[joint]
        energy = [0.5 * (robot.momentum(q + s * shift, dq)[0] * dq).sum(axis=-1) for s in (1, -1)]
        assert np.allclose((energy[0] - energy[1]) / (2 * h), ct_dq[..., joint], atol=1e-8)
    with pytest.raises(ValueError, match="end in 4"):
        robot.momentum(q[..., :3], dq[..., :3])


def test_a_robot_is_made_of_texts() -> None:
    folder = Path(ROBOT)
    robot = sn.Robot.from_text((folder / "robot.toml").read_text(), (folder / "biorob-like.urdf").read_text())
    named = sn.Robot(ROBOT)
    assert (robot.name, robot.joints) == (named.name, named.joints)
    assert (robot.stiffness_nm_per_rad == named.stiffness_nm_per_rad).all()
    assert robot.rope("elbow") == named.rope("elbow")


def test_one_wild_sample_is_rejected_and_changes_nothing(work: Path, learned: sn.Learned) -> None:
    clean = sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    wild = sn.OnlineEstimator(ROBOT, learned.learned_baseline)
    for i, (_, (dt, q, theta, tau_m, celsius)) in enumerate(samples(work, 60.0, 75.0)):
        if i == 4000:
            # The same sample is lost in one stream and wild in the other.
            lost, far = np.full_like(q, np.nan), np.array(q)
            far[1] = 1000.0
            assert clean.step(dt, lost, theta, tau_m, celsius).startswith("rejected: a joint position is missing")
            assert wild.step(dt, far, theta, tau_m, celsius) == "rejected: a value is too large or beyond reach"
            continue
        outcome = clean.step(dt, q, theta, tau_m, celsius)
        assert wild.step(dt, q, theta, tau_m, celsius) == outcome
        if outcome == "block":
            clean.work()
            wild.work()
    assert not np.isnan(clean.offset("elbow")).any()
    for joint in clean.joints:
        assert wild.offset(joint) == clean.offset(joint)
