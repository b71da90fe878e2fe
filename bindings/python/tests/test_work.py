"""While Rust works, Python continues, gets progress, and can interrupt."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED

# Long enough to be interrupted: minutes of simulation.
LONG = 'sn.simulate("examples/scenarios/work-session.toml", robot, duration_s=7200.0, progress=progress)'
LONG_FILE = """sn.simulate(
            "examples/scenarios/work-session.toml", robot, out=sys.argv[1], duration_s=7200.0, progress=progress)"""


def test_other_threads_continue() -> None:
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, duration_s=60.0)
    went_on = counted - before
    stop.set()
    thread.join()
    # Holding the lock would leave it at a handful.
    assert went_on > 10_000, went_on


def test_progress_is_reported() -> None:
    heard: list[tuple[float, str]] = []
    progress = lambda share, word: heard.append((share, word))  # noqa: E731
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, duration_s=60.0, progress=progress)
    shares = [share for share, _ in heard]
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert {word for _, word in heard} == {"simulating"}


def test_an_exception_of_the_callback_stops_the_work(tmp_path: Path) -> None:
    def enough(share: float, word: str) -> None:
        raise RuntimeError("enough")

    out = tmp_path / "long.mcap"
    with pytest.raises(RuntimeError, match="enough"):
        sn.simulate("examples/scenarios/work-session.toml", ROBOT, out=out, progress=enough)
    time.sleep(0.5)
    # Nothing half-written is left.
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("work", [LONG, LONG_FILE])
def test_ctrl_c_is_a_keyboard_interrupt(work: str, tmp_path: Path) -> None:
    code = f"""
    import sys, time, pysinew as sn
    robot = "{ROBOT}"
    told = []
    def progress(share, word):
        if not told:
            told.append(word)
            print("begun", flush=True)
    try:
        {work}
    except KeyboardInterrupt:
        # Python is itself again, and can work on.
        sn.estimate("{SHIPPED}", robot)
        print("interrupted", flush=True)
    """
    out = tmp_path / "out.mcap"
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), str(out)], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert process.stdout is not None
    # It is in the midst of its work, with hours of it left.
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=120)
    assert rest == "interrupted\n" and process.returncode == 0
    assert not out.exists()


def test_several_threads_work_at_once() -> None:
    answers: list[str] = []

    def one() -> None:
        answers.append(sn.estimate(SHIPPED, ROBOT).to_json())

    threads = [threading.Thread(target=one) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 3 and len(set(answers)) == 1


def test_import_costs_next_to_nothing() -> None:
    code = """
import sys
before = set(sys.modules)
import pysinew
loaded = {m.partition(".")[0] for m in set(sys.modules) - before}
assert "numpy" not in loaded, loaded
assert "json" not in loaded, loaded
pysinew.Robot("robots/biorob-like")
print(sorted(loaded))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not hasattr(__import__("os"), "fork"), reason="SKIPPED: no fork on this system")
def test_a_forked_process_works() -> None:
    """PyTorch's loaders fork; a pool of threads that outlives its call does not survive that."""
    code = f"""
import multiprocessing, pickle, warnings, pysinew as sn
warnings.simplefilter("ignore")

def one(seed):
    found = sn.estimate("{SHIPPED}", "{ROBOT}").to_json()
    rope = sn.predict_rope("liros-dc000-0301", tension_n=60.0, length_m=0.7, draws=8, seed=seed)
    rope.table("series")
    data = sn.Recording("{SHIPPED}").arrays()
    live = sn.OnlineEstimator("{ROBOT}")
    for k in range(3000):
        live.step(1e-3, data["q"][k], data["theta"][k])
        live.work()
    return found

wanted = one(1)
with multiprocessing.get_context("fork").Pool(2) as pool:
    assert set(pool.map(one, range(4))) == {{wanted}}
print("done")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=300)
    assert done.stdout == "done\n", done.stderr


INTERRUPTED = {
    "selection": "sn.select_rope(tension_n=60.0, length_m=0.7, draws=40_000, progress=progress)",
    "bootstrap": """sn.CreepTests(["examples/06-creep-test/rope-A.csv"]).fit(
        ["log-time", "findley", "burgers"], intervals="bootstrap", progress=progress)""",
    "scenario": 'sn.simulate("examples/scenarios/creep-and-retension.toml", duration_s=1e5, progress=progress)',
    "pretension": 'sn.plan_pretension("liros-dc000-0301", tension_n=60.0, length_m=0.7, draws=40_000, progress=progress)',
}


@pytest.mark.parametrize("name", INTERRUPTED)
def test_ctrl_c_interrupts_within_a_tenth_of_a_second(name: str) -> None:
    """And nothing works on behind it: the processor time afterwards is that of an idle process."""
    code = f"""
import os, signal, threading, time, warnings, pysinew as sn
warnings.simplefilter("ignore")
sent = []
def interrupt():
    time.sleep(1.0)
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
def progress(share, word):
    pass
threading.Thread(target=interrupt, daemon=True).start()
try:
    {INTERRUPTED[name]}
    print("not interrupted")
except KeyboardInterrupt:
    took = time.monotonic() - sent[0]
    time.sleep(0.3)
    before = time.process_time()
    time.sleep(0.5)
    print(took, time.process_time() - before)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    took, worked = (float(part) for part in done.stdout.split())
    # 0.1 s are promised; the rest is for a machine that does other work.
    assert took < 0.2, done.stdout
    assert worked < 0.1, done.stdout
