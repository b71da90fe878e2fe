#!/usr/bin/env python3
"""Makes the reference values beside this file, and checks them before writing.

    python3 -m venv venv && venv/bin/pip install 'pin>=4.1' 'mujoco>=4'
    venv/bin/python make_reference.py            # writes models/ (generated ones) and fixtures/
    venv/bin/python make_reference.py --check    # compares with what is committed, writes nothing

Values come from Pinocchio: p = M dq, C by computeCoriolisMatrix, g by computeGeneralizedGravity,
both energies. A robot is written only if

* dT/dq and dV/dq by central differences agree with C^T dq and g,
* MuJoCo, an engine of other people and another formulation, agrees on M, C dq + g and V.

Continuous joints are read as unlimited revolute joints; `mimic` and `dynamics` tags are ignored.
The hand-written models are models/{serial4,branching9,gantry6}.urdf; the larger ones are made here
from a fixed seed, links from random point masses so that their inertias are those of a body.
"""

import argparse
import hashlib
import json
import re
import sys
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
SEED = 20181
CASES = 12

# Gravity per robot; m/s^2. Not all robots stand upright.
GRAVITY = {
    "serial4": [0.0, 0.0, -9.81],
    "branching9": [3.1, -6.2, 5.4],
    "gantry6": [-1.2, 0.4, -9.7],
    "serial7": [0.0, 0.0, -9.81],
    "torso17": [0.0, 0.0, -9.81],
    "humanoid32": [0.0, -1.5, -9.6],
}


# --- models made from a seed -------------------------------------------------------------------


def limb(prefix, parent, kinds, length, mass):
    """Joints of one limb: (name, kind, parent, length of the parent link, mass)."""
    out = []
    for i, kind in enumerate(kinds):
        name = f"{prefix}_{i}"
        out.append((name, kind, parent, length, mass * 0.75**i))
        parent = name
    return out


def skeletons():
    """Name -> joints. R is revolute, P prismatic."""
    torso17 = [("waist", "R", None, 0.2, 9.0)]
    torso17 += limb("left", "waist", "RRRRRRR", 0.15, 2.2)
    torso17 += limb("right", "waist", "RRRRRRR", 0.15, 2.2)
    torso17 += limb("neck", "waist", "RR", 0.12, 1.5)
    humanoid32 = limb("left_leg", None, "RRRRRR", 0.22, 5.0)
    humanoid32 += limb("right_leg", None, "RRRRRR", 0.22, 5.0)
    humanoid32 += limb("waist", None, "RPR", 0.12, 8.0)
    humanoid32 += limb("left_arm", "waist_2", "RRRRRRR", 0.15, 2.2)
    humanoid32 += limb("right_arm", "waist_2", "RRRRRRR", 0.15, 2.2)
    humanoid32 += limb("head", "waist_2", "RPR", 0.1, 1.5)
    return {
        "serial7": limb("arm", None, "RRRRRRR", 0.18, 3.0),
        "torso17": torso17,
        "humanoid32": humanoid32,
    }


def numbers(values):
    return " ".join(f"{v:.9g}" for v in values)


def random_link(rng, name, mass, size):
    """Eight point masses in a box of the link's size; inertia about their common centre."""
    share = rng.uniform(0.4, 1.0, 8)
    share *= mass / share.sum()
    points = rng.uniform(-0.5, 0.5, (8, 3)) * [0.5 * size, 0.5 * size, size] + [0, 0, 0.5 * size]
    com = share @ points / mass
    arms = points - com
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(share, arms))
    names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    entries = " ".join(f'{k}="{inertia[at]:.9g}"' for k, at in names.items())
    return (
        f'  <link name="{name}">\n    <inertial>\n'
        f'      <origin xyz="{numbers(com)}"/>\n      <mass value="{mass:.9g}"/>\n'
        f"      <inertia {entries}/>\n    </inertial>\n  </link>\n"
    )


def generate(name, joints, rng):
    axes = np.vstack([np.eye(3), -np.eye(3)])
    text = '<?xml version="1.0"?>\n'
    text += f"<!-- Made by make_reference.py, seed {SEED}; no real robot. -->\n"
    text += f'<robot name="{name}">\n  <link name="pelvis"/>\n'
    for joint, kind, parent, length, mass in joints:
        xyz = rng.uniform(-0.2, 0.2, 3) * length + [0, 0, length if parent else 0]
        # Two of three origins are square, as CAD exports are.
        square = rng.integers(0, 4, 3) * (np.pi / 2) * (rng.random(3) < 0.4)
        rpy = square if rng.random() < 0.67 else rng.uniform(-1.5, 1.5, 3)
        axis = axes[rng.integers(0, 6)] if rng.random() < 0.8 else rng.normal(size=3)
        axis = axis / np.linalg.norm(axis)
        text += (
            f'  <joint name="{joint}" type="{"revolute" if kind == "R" else "prismatic"}">\n'
            f'    <parent link="{parent + "_link" if parent else "pelvis"}"/><child link="{joint}_link"/>\n'
            f'    <origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>\n'
            f'    <axis xyz="{numbers(axis)}"/>\n'
            f'    <limit lower="-3" upper="3" effort="50" velocity="6"/>\n  </joint>\n'
        )
        text += random_link(rng, f"{joint}_link", mass, length)
    return text + "</robot>\n"


# --- values ------------------------------------------------------------------------------------


def as_revolute(text):
    """Continuous joints as unlimited revolute ones."""

    def bounded(match):
        body = re.sub(r"<limit[^>]*/>", "", match.group(0)).replace('"continuous"', '"revolute"')
        return body.replace("</joint>", '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>')

    return re.sub(r'<joint[^>]*type="continuous".*?</joint>', bounded, text, flags=re.S)


def evaluate(model, data, q, dq):
    # crba fills the upper triangle only.
    mass = np.triu(pin.crba(model, data, q))
    mass = mass + np.triu(mass, 1).T
    coriolis = pin.computeCoriolisMatrix(model, data, q, dq).copy()
    return {
        "M": mass,
        "p": mass @ dq,
        "ct_dq": coriolis.T @ dq,
        "g": pin.computeGeneralizedGravity(model, data, q).copy(),
        "c_dq": coriolis @ dq,
        "kinetic_energy": pin.computeKineticEnergy(model, data, q, dq),
        "potential_energy": pin.computePotentialEnergy(model, data, q),
    }


def central(f, q):
    """Gradient by fourth-order central differences; error about h^4 f5/30 + eps |f|/h."""
    h = 1e-3
    out = np.zeros(len(q))
    for i in range(len(q)):
        e = np.zeros(len(q))
        e[i] = h
        out[i] = (8 * (f(q + e) - f(q - e)) - (f(q + 2 * e) - f(q - 2 * e))) / (12 * h)
    return out


def relative(a, b):
    return np.max(np.abs(np.asarray(a) - b)) / max(np.max(np.abs(b)), 1e-9)


def check_numerically(name, model, data, case):
    q, dq = np.array(case["q"]), np.array(case["dq"])
    dt_dq = central(lambda x: pin.computeKineticEnergy(model, data, x, dq), q)
    dv_dq = central(lambda x: pin.computePotentialEnergy(model, data, x), q)
    # Scales: rounding of an energy E is eps E / h in its difference quotient.
    for what, ours, reference, energy in [
        ("dT/dq", case["ct_dq"], dt_dq, case["kinetic_energy"]),
        ("dV/dq", case["g"], dv_dq, case["potential_energy"]),
    ]:
        limit = 1e-9 * max(1.0, abs(energy), np.max(np.abs(reference)))
        worst = np.max(np.abs(np.array(ours) - reference))
        if worst > limit:
            sys.exit(f"{name}: {what} differs by {worst:.2e} (limit {limit:.2e})")


def mujoco_model(text, gravity):
    body = re.sub(r"<mimic[^>]*/>", "", text)
    body = re.sub(r"<dynamics[^>]*/>", "", body)
    compiler = '<mujoco><compiler balanceinertia="false" fusestatic="true"/></mujoco>'
    model = mujoco.MjModel.from_xml_string(re.sub(r"(<robot[^>]*>)", r"\1" + compiler, body, count=1))
    model.opt.gravity[:] = gravity
    # Joint limits would add constraint forces; only smooth dynamics are asked for.
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    return model


def check_with_mujoco(name, text, gravity, joints, cases, matrices):
    model = mujoco_model(text, gravity)
    data = mujoco.MjData(model)
    at = [model.joint(j).dofadr[0] for j in joints]
    worst = 0.0
    zero_potential = None
    for case, mass in zip(cases, matrices):
        data.qpos[at] = case["q"]
        data.qvel[at] = case["dq"]
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        full = full[np.ix_(at, at)]
        bias = np.array(case["c_dq"]) + case["g"]
        mujoco.mj_energyPos(model, data)
        potential = data.energy[0] - case["potential_energy"]
        # MuJoCo counts bodies fixed to the base too: a constant.
        zero_potential = potential if zero_potential is None else zero_potential
        worst = max(
            worst,
            relative(full, mass),
            relative(data.qfrc_bias[at], bias),
            abs(potential - zero_potential) / max(1.0, abs(case["potential_energy"])),
        )
    # MuJoCo stores principal inertias and quaternions: its compiler's eigendecomposition
    # costs digits, its dynamics don't.
    if worst > 1e-10:
        sys.exit(f"{name}: MuJoCo differs by {worst:.2e}")
    return worst


def make(name, text, rng):
    gravity = GRAVITY[name]
    model = pin.buildModelFromXML(as_revolute(text))
    model.gravity.linear = np.array(gravity)
    data = model.createData()
    joints = list(model.names)[1:]
    if any(j.nq != 1 or j.nv != 1 for j in list(model.joints)[1:]):
        sys.exit(f"{name}: a joint with more than one coordinate")
    kinds = ["prismatic" if "JointModelP" in j.shortname() else "revolute" for j in list(model.joints)[1:]]
    reach = np.where(np.array(kinds) == "prismatic", 0.4, np.pi)
    n = model.nq
    states = [(np.zeros(n), np.zeros(n)), (np.zeros(n), np.ones(n))]
    while len(states) < CASES:
        states.append((rng.uniform(-1, 1, n) * reach, rng.uniform(-1, 1, n) * np.where(reach < 1, 1.0, 3.0)))
    # One encoder that has wrapped many times: large angles must not cost digits.
    turns = np.where(reach < 1, 0.0, 2 * np.pi * rng.integers(-40, 40, n))
    states[-1] = (states[-1][0] + turns, states[-1][1])
    cases, matrices = [], []
    for q, dq in states:
        values = evaluate(model, data, q, dq)
        matrices.append(values.pop("M"))
        case = {"q": q, "dq": dq, **values}
        cases.append({k: v.tolist() if isinstance(v, np.ndarray) else float(v) for k, v in case.items()})
        check_numerically(name, model, data, cases[-1])
    agreement = check_with_mujoco(name, text, gravity, joints, cases, matrices)
    print(f"{name}: {n} joints, {len(cases)} cases, MuJoCo {mujoco.__version__} agrees to {agreement:.1e}")
    return {
        "urdf_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "generator": f"pinocchio {pin.__version__}",
        "base": "fixed",
        "joints": joints,
        "kinds": kinds,
        "gravity": gravity,
        "cases": cases,
    }


def as_text(fixture):
    """One case per line: readable differences, small file."""
    head = {k: v for k, v in fixture.items() if k != "cases"}
    cases = ",\n".join(json.dumps(c) for c in fixture["cases"])
    return json.dumps(head)[:-1] + ', "cases": [\n' + cases + "\n]}\n"


def compare(name, ours, committed):
    worst = 0.0
    for a, b in zip(ours["cases"], committed["cases"], strict=True):
        worst = max(worst, *(relative(a[k], np.array(b[k])) for k in a))
    if ours["urdf_sha256"] != committed["urdf_sha256"] or worst > 1e-12:
        sys.exit(f"{name}: the committed values differ (worst {worst:.1e}); run without --check")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    check = parser.parse_args().check
    for name, joints in skeletons().items():
        text = generate(name, joints, np.random.default_rng([SEED, len(joints)]))
        path = HERE / "models" / f"{name}.urdf"
        if not check:
            path.write_text(text)
        elif path.read_text() != text:
            sys.exit(f"{path.name} is not what the script makes")
    for index, name in enumerate(GRAVITY):
        text = (HERE / "models" / f"{name}.urdf").read_text()
        fixture = make(name, text, np.random.default_rng([SEED, 1000 + index]))
        path = HERE / "fixtures" / f"{name}.json"
        if check:
            compare(name, fixture, json.loads(path.read_text()))
        else:
            path.write_text(as_text(fixture))


if __name__ == "__main__":
    main()
