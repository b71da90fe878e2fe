#!/usr/bin/env python3
"""Sinew's momentum pass, and code written for one robot, beside Pinocchio, CasADi and MuJoCo: same robots, states and core,
same run.

    benches/peers/run.py                   # our own models, 4 to 32 joints
    benches/peers/run.py --models DIR      # any folder of URDFs
    benches/peers/run.py --quick           # a second per program instead of several
    benches/peers/run.py --sinew FILE      # a `sinew` that is built; else cargo builds it, to write a robot's code with

Needs python3 with venv, gcc or clang (both: apt-get install clang), cargo. Installs `pin`,
`cmeel-eigen`, `casadi` and `mujoco` from PyPI into a virtual environment under target/peers.

Programs are run in turn in several rounds, pinned to one core; the reported value of a program is its smallest
time per pass over all rounds, which is what the code costs when nothing disturbs it. Each program
writes the values it computed; the run fails unless they agree to 1e-9. Meshes are ignored, because they do not affect
the computations.
A robot that a program cannot read is reported with the reason and skipped; the other robots are measured.
"""

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WORK = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "peers"
OWN = ROOT / "crates/sinew-model/tests/reference/models"
OWN_ROBOTS = ["serial4", "serial7", "torso17", "humanoid32"]
TOLERANCE = 1e-9
STATES = 64
SEED = 11


def environment():
    """Re-executes this script inside the virtual environment, making that first if needed."""
    python = WORK / "venv/bin/python"
    if Path(sys.prefix) == WORK / "venv":
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", WORK / "venv"], check=True)
    packages = ["pin>=4.1", "cmeel-eigen", "casadi>=3.7", "mujoco>=4"]
    subprocess.run([python, "-m", "pip", "install", "-q", *packages], check=True)
    os.execv(python, [python, __file__, *sys.argv[1:]])


environment()

import casadi  # noqa: E402
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402

sys.path.insert(0, str(ROOT / "crates/sinew-model/tests/reference"))
sys.path.insert(0, str(HERE))
import casadi_pass  # noqa: E402
from make_reference import as_revolute, mujoco_model  # noqa: E402

GRAVITY = [0.0, 0.0, -9.81]


# --- programs ----------------------------------------------------------------------------------


def compile_newer(command, output, sources):
    """Runs a compiler unless its output is newer than all sources."""
    stamp = output.stat().st_mtime if output.exists() else 0
    if all(Path(s).stat().st_mtime < stamp for s in sources):
        return
    print("building", output.name, flush=True)
    subprocess.run(command, check=True)


def build_programs():
    """Name -> (path, engine)."""
    programs = {}
    cargo = ["cargo", "build", "-q", "--release", "--manifest-path", HERE / "sinew/Cargo.toml"]
    for label, flags in [("default", ""), ("native", "-C target-cpu=native")]:
        target = WORK / f"sinew-{label}"
        env = {**os.environ, "RUSTFLAGS": flags, "CARGO_TARGET_DIR": str(target)}
        subprocess.run(cargo, env=env, check=True)
        programs[f"sinew, {label}"] = (target / "release/peer-sinew", "sinew")

    prefix = Path(pin.__file__).parents[4]
    # What Pinocchio's CMake target gives to those who link it.
    include = [f"-I{prefix}/include", f"-I{prefix}/include/eigen3", "-DBOOST_MPL_LIMIT_LIST_SIZE=30"]
    include += ["-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    include += ["-DBOOST_FUSION_INVOKE_MAX_ARITY=12", "-w"]
    for compiler in ["g++", "clang++"]:
        if not shutil.which(compiler):
            print(f"{compiler} is not installed; its builds are left out (apt-get install clang)")
            continue
        for label, flags in [("default", []), ("native", ["-march=native"])]:
            out = WORK / f"peer-pinocchio-{compiler}-{label}"
            source = HERE / "pinocchio.cpp"
            command = [compiler, "-std=c++17", "-O3", "-DNDEBUG", *flags, *include, source, "-o", out]
            library = [f"-L{prefix}/lib", "-lpinocchio_default", f"-Wl,-rpath,{prefix}/lib"]
            compile_newer(command + library, out, [source])
            programs[f"pinocchio, {compiler}, {label}"] = (out, "pinocchio")

    package = Path(mujoco.__file__).parent
    library = next(package.glob("libmujoco.so*"))
    out, source = WORK / "peer-mujoco", HERE / "mujoco.c"
    cc = "gcc" if shutil.which("gcc") else "clang"
    command = [cc, "-O3", f"-I{package}/include", source, library, f"-Wl,-rpath,{package}", "-o", out]
    compile_newer(command, out, [source])
    programs["mujoco, as packaged"] = (out, "mujoco")
    return programs


def write_code(robot, sinew):
    """Returns the generated programs for this robot: name -> (path, engine)."""
    folder = WORK / f"{robot.name}-code"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy(robot.urdf, folder)
    joints = "".join(f'[joints."{name}"]\nstiffness_nm_per_rad = 40.0\n' for name in robot.joints)
    (folder / "robot.toml").write_text(f'urdf = "{robot.urdf.name}"\n{joints}')
    command = [*sinew, "robot", "generate", folder, "--lang", "c", "--out", folder]
    asked("Sinew", lambda: subprocess.run(command, check=True, capture_output=True, cwd=ROOT))
    header = next(folder.glob("*.h"))
    own = header.with_suffix(".c")
    names = re.search(r"joint_names\[[^]]*\] = \{(.*?)\}", own.read_text(), re.S)[1]
    robot.generated_order = [robot.joints.index(name) for name in re.findall(r'"([^"]*)"', names)]
    robot.write_states("generated", robot.generated_order)
    work = casadi_pass.write(robot.model, GRAVITY, folder, "casadi_code")
    common = ["-std=gnu99", "-O3", f"-DJOINTS={robot.n}", HERE / "generated.c", "-lm"]
    sources = {
        "sinew generated": ([own, f"-DPASS={header.stem}_momentum", "-include", header], "generated"),
        "casadi generated": ([folder / "casadi_code.c", "-DCASADI", f"-DCASADI_WORK={work}"], "casadi"),
    }
    programs = {}
    for compiler in ["gcc", "clang"]:
        if not shutil.which(compiler):
            continue
        for label, flags in [("default", []), ("native", ["-march=native"])]:
            for name, (source, engine) in sources.items():
                out = folder / f"{engine}-{compiler}-{label}"
                subprocess.run([compiler, *flags, *source, *common, "-o", out], check=True)
                programs[f"{name}, {compiler}, {label}"] = (out, engine)
    return programs


# --- robots ------------------------------------------------------------------------------------


def listing(model):
    """The model as pinocchio.cpp reads it."""
    rows = [" ".join(map(repr, [model.nv, *map(float, model.gravity.linear)]))]
    for i in range(1, model.njoints):
        joint, place, body = model.joints[i], model.jointPlacements[i], model.inertias[i]
        kind = joint.shortname()
        axis = joint.extract().axis if "Unaligned" in kind and hasattr(joint, "extract") else np.zeros(3)
        values = [*axis, *place.rotation.ravel(), *place.translation]
        values += [body.mass, *body.lever, *body.inertia.ravel()]
        rows.append(" ".join([model.names[i], kind, str(model.parents[i]), *(repr(float(v)) for v in values)]))
    return "\n".join(rows) + "\n"


class Refused(Exception):
    """Error of an engine that cannot read a robot."""


def asked(engine, of, *arguments):
    """Result of an engine for a robot."""
    try:
        return of(*arguments)
    except (ValueError, RuntimeError, subprocess.CalledProcessError) as error:
        said = getattr(error, "stderr", None) or str(error)
        said = said.decode() if isinstance(said, bytes) else said
        raise Refused(f"{engine} refuses it: {(said.strip().splitlines() or ['no reason given'])[0]}") from error


def without_shapes(text):
    """Returns a description without visual and collision elements, because their meshes may be missing."""
    return re.sub(r"<(visual|collision)\b(?:[^>]*/>|.*?</\1>)", "", text, flags=re.S)


class Robot:
    """Input files of one robot for each engine, and the order of its joints there."""

    def __init__(self, urdf):
        self.name, self.urdf = urdf.stem, urdf
        text = without_shapes(urdf.read_text())
        model = asked("Pinocchio", pin.buildModelFromXML, as_revolute(text))
        model.gravity.linear = np.array(GRAVITY)
        self.joints = list(model.names)[1:]
        self.n, self.model = model.nv, model
        rng = np.random.default_rng(SEED)
        reach = np.array(["JointModelP" not in j.shortname() for j in list(model.joints)[1:]])
        reach = np.where(reach, np.pi, 0.3)
        self.q = rng.uniform(-1, 1, (STATES, self.n)) * reach
        self.dq = rng.uniform(-2, 2, (STATES, self.n))
        self.files = WORK / self.name
        self.files.with_suffix(".model").write_text(listing(model))
        self.write_states("pinocchio", range(self.n))
        other = asked("MuJoCo", mujoco_model, text, GRAVITY)
        mujoco.mj_saveModel(other, str(self.files.with_suffix(".mjb")))
        self.mujoco_order = [int(other.joint(j).dofadr[0]) for j in self.joints]
        self.write_states("mujoco", np.argsort(self.mujoco_order))

    def states(self, engine):
        order = engine if engine in ["mujoco", "generated"] else "pinocchio"
        return self.files.with_suffix(f".{order}.states")

    def write_states(self, engine, order):
        order = list(order)
        rows = [" ".join(self.joints[i] for i in order)]
        for q, dq in zip(self.q, self.dq):
            rows.append(" ".join(repr(float(x)) for x in [*q[order], *dq[order]]))
        self.states(engine).write_text("\n".join(rows) + "\n")

    def time(self, program, engine, core, seconds):
        """Least ns per pass, and the three values per state, in Pinocchio's order."""
        dump = self.files.with_suffix(".dump")
        head = {
            "sinew": [self.urdf, *map(str, GRAVITY)],
            "pinocchio": [self.files.with_suffix(".model")],
            "mujoco": [self.files.with_suffix(".mjb")],
            "generated": [],
            "casadi": [],
        }[engine]
        pinned = ["taskset", "-c", str(core)] if shutil.which("taskset") else []
        done = subprocess.run(
            [*pinned, program, *head, self.states(engine), str(seconds), dump],
            check=True, capture_output=True, text=True,
        )
        values = np.loadtxt(dump).reshape(STATES, 3, self.n)
        if engine == "mujoco":
            values = values[:, :, self.mujoco_order]
        if engine == "generated":
            values = values[:, :, np.argsort(self.generated_order)]
        return float(done.stdout), values


def differences(robot, values):
    """Worst relative difference of the engines' values from Pinocchio's."""
    reference = next(v for k, v in values.items() if k.startswith("pinocchio"))
    out = {}
    for name, ours in values.items():
        # MuJoCo's second value is the bias C dq + g, which has no counterpart here.
        which = [0, 2] if name.startswith("mujoco") else [0, 1, 2]
        size = np.abs(reference).max(axis=2, keepdims=True).clip(1e-9)
        worst = (np.abs(ours - reference) / size)[:, which].max()
        out[name] = worst
        if worst > TOLERANCE:
            sys.exit(f"{robot.name}: {name} differs from Pinocchio by {worst:.1e}")
    return out


def cpu():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(x.split(":")[1].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def version(command):
    return subprocess.run([command, "--version"], capture_output=True, text=True).stdout.splitlines()[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--models", type=Path, help="folder of URDFs instead of our own")
    parser.add_argument("--core", type=int, default=sorted(os.sched_getaffinity(0))[-1])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="two short rounds")
    parser.add_argument("--sinew", type=Path, help="a command that is built already")
    args = parser.parse_args()
    sinew = [args.sinew.resolve()] if args.sinew else ["cargo", "run", "-q", "-p", "sinew", "--"]
    rounds, seconds = (2, 0.25) if args.quick else (args.rounds, 0.5)
    WORK.mkdir(parents=True, exist_ok=True)

    programs = build_programs()
    urdfs = sorted(args.models.glob("*.urdf")) if args.models else [OWN / f"{r}.urdf" for r in OWN_ROBOTS]
    tools = [version(c) for c in ["rustc", "g++", "gcc", "clang++"] if shutil.which(c)]
    print(f"{cpu()}, core {args.core}; pinocchio {pin.__version__}, casadi {casadi.__version__}, mujoco {mujoco.__version__}")
    print("; ".join(tools))
    print(f"least time per pass of {rounds} rounds of {seconds} s each, in turn; {STATES} random states\n")

    aim_missed, left_out, measured = False, [], 0
    for urdf in urdfs:
        values = {}
        try:
            robot = Robot(urdf)
            all_programs = {**programs, **write_code(robot, sinew)}
            best = {name: float("inf") for name in all_programs}
            for _ in range(rounds):
                for name, (path, engine) in all_programs.items():
                    ns, values[name] = asked(name, robot.time, path, engine, args.core, seconds)
                    best[name] = min(best[name], ns)
        except Refused as refused:
            print(f"{urdf.stem}: left out, {refused}\n", flush=True)
            left_out.append(urdf.stem)
            continue
        measured += 1
        worst = differences(robot, values)
        ours = best["sinew, default"]
        print(f"{robot.name}, {robot.n} joints; values agree to {max(worst.values()):.0e}")
        print(f"  {'':32} {'ns':>9} {'x sinew, default':>17} {'x sinew, native':>17}")
        for name, ns in best.items():
            print(f"  {name:32} {ns:9.1f} {ns / ours:17.2f} {ns / best['sinew, native']:17.2f}")
        pinocchio = min(ns for name, ns in best.items() if name.startswith("pinocchio"))
        aim_missed |= ours * 10 > pinocchio
        print(f"  best Pinocchio build / sinew at the default target: {pinocchio / ours:.1f}\n", flush=True)
    if left_out:
        print("left out:", ", ".join(left_out))
    if not measured or (left_out and not args.models):
        sys.exit("every one of our own models must be measured" if not args.models else "no robot was measured")
    print("aim of a tenth of the best Pinocchio build's time:", "missed on some" if aim_missed else f"met on all {measured}")


if __name__ == "__main__":
    main()
