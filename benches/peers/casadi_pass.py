"""The momentum terms of an arm as CasADi makes code of them.

T = sum of m v²/2 + ω I ω/2 and V = -sum of m γ r of all bodies are written down as they stand in a textbook. CasADi's
algorithmic differentiation gives p = ∂T/∂dq, C^T dq = ∂T/∂q and g = ∂V/∂q, and its generator straight-line C.
"""

import casadi as ca
import numpy as np


def write(model, gravity, folder, name):
    """Writes `name`.c with `casadi_pass`; returns the length of its work vector."""
    n = model.nv
    q, dq = ca.SX.sym("q", n), ca.SX.sym("dq", n)
    rotation, origin = [ca.SX.eye(3)], [ca.SX.zeros(3)]
    omega, velocity = [ca.SX.zeros(3)], [ca.SX.zeros(3)]
    kinetic, potential = 0, 0
    for i in range(1, model.njoints):
        parent, place, joint = model.parents[i], model.jointPlacements[i], model.joints[i]
        frame, at = ca.SX(place.rotation), ca.SX(place.translation)
        axis, slides = axis_of(joint)
        k = joint.idx_v
        step = rotation[parent] @ at
        turned = rotation[parent] @ frame
        direction = turned @ axis
        spin, own = omega[parent], velocity[parent] + ca.cross(omega[parent], step)
        if slides:
            step_along = direction * q[k]
            own = own + ca.cross(spin, step_along) + direction * dq[k]
            step = step + step_along
        else:
            spin = spin + direction * dq[k]
            turned = turned @ rotation_about(axis, q[k])
        rotation.append(turned)
        origin.append(origin[parent] + step)
        omega.append(spin)
        velocity.append(own)
        body = model.inertias[i]
        lever = turned @ ca.SX(body.lever)
        centre = own + ca.cross(spin, lever)
        local = turned.T @ spin
        kinetic += 0.5 * (body.mass * ca.dot(centre, centre) + ca.dot(local, ca.SX(body.inertia) @ local))
        potential -= body.mass * ca.dot(ca.SX(np.array(gravity)), origin[-1] + lever)
    terms = [ca.gradient(kinetic, dq), ca.gradient(kinetic, q), ca.gradient(potential, q)]
    terms = [ca.densify(term) for term in terms]
    function = ca.Function("casadi_pass", [q, dq], terms, {"cse": True})
    generator = ca.CodeGenerator(name + ".c")
    generator.add(function)
    generator.generate(str(folder) + "/")
    return max(1, function.sz_w())


def axis_of(joint):
    """Axis in the joint's frame, and whether it slides."""
    kind = joint.shortname()
    slides = kind.startswith("JointModelP")
    if "Unaligned" in kind:
        return ca.SX(np.array(joint.extract().axis)), slides
    axis = np.zeros(3)
    axis["XYZ".index(kind[-1])] = 1
    return ca.SX(axis), slides


def rotation_about(axis, angle):
    """Rodrigues' formula; zeros of the axis stay zeros."""
    x, y, z = axis[0], axis[1], axis[2]
    k = ca.vertcat(ca.horzcat(0, -z, y), ca.horzcat(z, 0, -x), ca.horzcat(-y, x, 0))
    return ca.SX.eye(3) + ca.sin(angle) * k + (1 - ca.cos(angle)) * (k @ k)
