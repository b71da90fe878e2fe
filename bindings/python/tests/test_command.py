"""The command inside the wheel behaves as the program does."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED


def run(sinew: str, *arguments: str, **options):
    return subprocess.run([sinew, *arguments], capture_output=True, text=True, cwd=ROOT, check=False, **options)


def test_command_version_and_errors(sinew: str) -> None:
    assert run(sinew, "--version").stdout == f"sinew {sn.__version__}\n"
    wrong = run(sinew, "estimat")
    assert wrong.returncode == 2 and "estimate" in wrong.stderr
    refused = run(sinew, "estimate", "missing.mcap")
    assert refused.returncode == 1 and refused.stderr.startswith("error: missing.mcap")
    module = subprocess.run([sys.executable, "-m", "pysinew", "--version"], capture_output=True, text=True, check=True)
    assert module.stdout == f"sinew {sn.__version__}\n"


def test_every_feature_is_built_in(sinew: str, tmp_path) -> None:
    # Pictures and the camera are features of the program.
    plot = tmp_path / "choice.png"
    done = run(sinew, "rope", "select", "--tension", "60", "--length", "700", "--draws", "20", "--plot", str(plot))
    assert done.returncode == 0, done.stderr
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert "read-camera" in run(sinew, "bench", "--help").stdout


def test_a_reader_that_goes(sinew: str) -> None:
    gone = f"{sinew} rope list --json | head -c 10; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", gone], capture_output=True, text=True, cwd=ROOT, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_ctrl_c_ends_it(sinew: str, tmp_path: Path) -> None:
    scenario, out = "examples/scenarios/work-session.toml", tmp_path / "long.mcap"
    process = subprocess.Popen([sinew, "simulate", scenario, "--duration", "7200", "--out", out, "--quiet"], cwd=ROOT)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10) == -signal.SIGINT


def test_shipped_example_by_the_command(sinew: str) -> None:
    done = run(sinew, "estimate", SHIPPED, "--robot", ROBOT)
    assert done.returncode == 0 and "shoulder_pitch" in done.stdout
