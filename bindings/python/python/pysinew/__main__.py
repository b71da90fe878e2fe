"""The command ``sinew``."""

from __future__ import annotations

import sys


def main() -> int:
    """Runs the command line with the arguments of the process."""
    import signal

    from ._core import run_command

    # Ctrl-C ends the command as it ends any other program; Python has nothing to clean up.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_command(["sinew", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
