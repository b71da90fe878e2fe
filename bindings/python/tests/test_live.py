"""Sample by sample: what a control loop would see."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT


def test_live_offsets_follow_a_session(work: Path, learned: sn.Learned) -> None:
    robot = sn.Robot(ROBOT)
    live = sn.LiveOffsets(robot, learned.learned_baseline)
    arrays = sn.Recording(work).arrays(joints=robot.joints)
    later = arrays["time_ns"] - arrays["time_ns"][0] >= 60e9
    late = arrays["time_ns"] - arrays["time_ns"][0] < 120e9
    rows = np.flatnonzero(later & late)
    dt = np.diff(arrays["time_ns"][rows], prepend=arrays["time_ns"][rows][0]) * 1e-9
    updates = 0
    assert live.in_doubt
    with pytest.raises(ValueError, match="in doubt"):
        live.save("early", 0)
    for i, row in enumerate(rows):
        celsius = float(arrays["temperature_c"][row]) if "temperature_c" in arrays else float("nan")
        told = live.step(float(dt[i]), arrays["q"][row], arrays["theta"][row], arrays["tau_m"][row], celsius)
        updates += told == "updated"
    # Five blocks a second, once the filters have settled.
    assert 230 < updates < 300, updates
    batch = sn.estimate(work, robot, baseline=learned.learned_baseline, from_s=60.0, to_s=120.0)
    means, deviations = live.offsets()
    for i, joint in enumerate(robot.joints):
        mean, deviation = live.offset(joint)
        assert (mean, deviation) == (means[i], deviations[i])
        wanted = batch.joint(joint).offset_rad
        assert abs(mean - wanted.mean) < 2.0 * max(1.96 * deviation, wanted.half_width_95), joint
    # Unknown where the recording holds no temperature, and nowhere else.
    unknown_rad = live.unknown_temperature_rad
    assert unknown_rad.shape == (len(robot.joints),) and (unknown_rad <= deviations).all()
    assert (unknown_rad > 0.0).any() == ("temperature_c" not in arrays)
    force = live.external_force
    assert force is not None
    probability, force_n, deviation_n = force
    assert 0.0 <= probability < 0.3, "nothing pulls"
    assert force_n.shape == deviation_n.shape == (3,) and (deviation_n > 0.0).all()
    if not live.in_doubt:
        saved = live.save("session", int(arrays["time_ns"][rows[-1]]))
        assert saved.recordings[-1] == "session"
        sn.LiveOffsets(robot, saved)


def test_an_estimate_says_what_the_form_beside_the_robot_makes_of_it(work: Path, learned: sn.Learned) -> None:
    asked = {"baseline": learned.learned_baseline, "from_s": 60.0, "to_s": 120.0}
    answer = sn.estimate(work, ROBOT, **asked, live=True)
    assert answer.session is not None and answer.session.live is not None
    course = answer.session.live
    assert [joint.name for joint in course.joints] == [joint.name for joint in answer.session.joints]
    assert course.doubts[0].to_s > course.doubts[0].from_s
    plain = sn.estimate(work, ROBOT, **asked)
    assert plain.session is not None and plain.session.live is None
    with pytest.raises(ValueError, match="live is for the absolute estimate"):
        sn.estimate(work, ROBOT, method="paper", live=True)


def test_what_is_stated_of_a_running_robot(learned: sn.Learned) -> None:
    stated = sn.LiveOffsets(ROBOT, learned.learned_baseline, external_force_n=((0.0, 1.0, 0.0), 0.1), creep_rad_per_s=0.0)
    for wrong in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="creep_rad_per_s"):
            sn.LiveOffsets(ROBOT, learned.learned_baseline, creep_rad_per_s=wrong)
    assert stated.external_force is None or stated.external_force[0] == 1.0


def test_bounded_work_gives_the_same_offsets_one_block_later(work: Path, learned: sn.Learned) -> None:
    arrays = sn.Recording(work).arrays(joints=sn.Robot(ROBOT).joints)
    time_s = (arrays["time_ns"] - arrays["time_ns"][0]) * 1e-9
    rows = np.flatnonzero(time_s < 20.0)
    whole, bounded = (sn.LiveOffsets(ROBOT, learned.learned_baseline) for _ in range(2))
    for period_s in (0.0, -1e-3, float("nan")):
        with pytest.raises(ValueError, match="time step"):
            bounded.bound_work(period_s)
    dt = np.diff(time_s[rows], prepend=time_s[rows][0])
    assert bounded.bound_work(float(dt.max())) > 1
    told: list[list[list[np.ndarray]]] = [[], []]
    for i, row in enumerate(rows):
        for live, updates in zip((whole, bounded), told):
            if live.step(float(dt[i]), arrays["q"][row], arrays["theta"][row]) == "updated":
                updates.append([array.copy() for array in live.offsets()])
    assert len(told[0]) > 50 and len(told[0]) - len(told[1]) in (0, 1)
    for a, b in zip(*told):
        np.testing.assert_array_equal(a, b)
    assert (whole.blocks_left_out, bounded.blocks_left_out) == (0, 0)
    # A step for samples every ten microseconds does a slice or two: those at a fiftieth of a second find work undone.
    late = sn.LiveOffsets(ROBOT, learned.learned_baseline)
    late.bound_work(1e-5)
    for i, row in enumerate(rows[::10]):
        late.step(float(np.sum(dt[10 * i : 10 * i + 10])), arrays["q"][row], arrays["theta"][row])
    assert late.blocks_left_out > 0


def test_a_baseline_is_a_text(learned: sn.Learned) -> None:
    text = learned.learned_baseline.to_text()
    again = sn.Baseline.from_text(text)
    assert again.to_text() == text and again.joints == learned.learned_baseline.joints
    with pytest.raises(ValueError, match="mine: not a baseline"):
        sn.Baseline.from_text("{}", name="mine")


def test_samples_that_can_not_be_used_change_nothing(learned: sn.Learned) -> None:
    live = sn.LiveOffsets(ROBOT, learned.learned_baseline)
    q = [0.1, 0.2, 0.3, 0.4]
    assert live.step(0.0, q, q) == "restarted"
    assert live.step(0.002, q, q) == "taken"
    assert live.step(0.002, [0.1, float("nan"), 0.3, 0.4], q).startswith("refused: a joint position")
    assert live.step(0.002, q, [float("nan")] * 4).startswith("refused: a motor position")
    for wrong in (0.0, -1.0, float("nan"), 1e10):
        with pytest.raises(ValueError, match="time step"):
            live.step(wrong, q, q)
    with pytest.raises(ValueError, match="one entry per joint"):
        live.step(0.002, q[:3], q)
    assert live.step(0.002, q, q) == "taken"
    live.interrupt()
    assert live.step(0.002, q, q) == "restarted"
    with pytest.raises(ValueError, match="joints are shoulder_yaw"):
        live.offset("hip")


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
    # p = M(q) dq is linear in dq; g doesn't depend on it.
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
