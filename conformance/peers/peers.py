"""The tools in the comparison, and an environment for each: `python conformance/peers/peers.py` makes them.

Each is installed from PyPI into build/peers/<name>, a virtual environment of its own. One that cannot be
installed is reported by whoever wanted to ask it, and does not stop the others.
"""

from __future__ import annotations

import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ENVIRONMENTS = HERE.parents[1] / "build" / "peers"


@dataclass(frozen=True)
class Peer:
    """A tool: its name on PyPI and in tables, its adapter, and its build dependencies (Debian packages)."""

    name: str
    label: str
    adapter: str
    needs: str = ""

    @property
    def python(self) -> Path:
        """The interpreter of its environment."""
        return ENVIRONMENTS / self.name / "bin" / "python"

    @property
    def log(self) -> Path:
        """The log of its installation."""
        return ENVIRONMENTS / f"{self.name}.log"

    @property
    def installed(self) -> bool:
        """Whether its installation succeeded."""
        return (ENVIRONMENTS / self.name / "installed").exists()

    def command(self) -> list[str]:
        """Return the command that starts its adapter."""
        return [str(self.python), str(HERE / self.adapter)]

    def why_not(self) -> str:
        """Return the last line of an installation that failed."""
        if not self.log.exists():
            return "not installed yet: make peers"
        lines = [line for line in self.log.read_text(errors="replace").splitlines() if "rror" in line]
        hint = f"; its build needs {self.needs}" if self.needs else ""
        return (lines[-1].strip() if lines else "its installation failed") + hint


PEERS = (
    Peer(
        "rtamt", "RTAMT", "ask_rtamt.py"
    ),  # the paper's tool; ours has its name, hence the environment of its own
    Peer("reelay", "Reelay", "ask_reelay.py"),
    Peer("stlrom", "STLRom", "ask_stlrom.py", needs="flex, bison and libfl-dev"),
    Peer("mstlo-python", "mstlo", "ask_mstlo.py"),
    Peer("metric-temporal-logic", "py-metric-temporal-logic", "ask_mtl.py"),
)


def install(peer: Peer) -> None:
    """Create the environment of a peer if necessary."""
    if peer.installed:
        return
    venv.create(ENVIRONMENTS / peer.name, with_pip=True, clear=True)
    command = [str(peer.python), "-m", "pip", "install", "--disable-pip-version-check", peer.name]
    with peer.log.open("w", encoding="utf-8") as log:
        done = subprocess.run(command, stdout=log, stderr=log, check=False)
    if done.returncode == 0:
        (ENVIRONMENTS / peer.name / "installed").touch()


def main() -> None:
    """Install all peers, and report the results."""
    ENVIRONMENTS.mkdir(parents=True, exist_ok=True)
    for peer in PEERS:
        sys.stderr.write(f"{peer.name} ... ")
        sys.stderr.flush()
        install(peer)
        sys.stderr.write("installed\n" if peer.installed else f"NOT INSTALLED: {peer.why_not()}\n")


if __name__ == "__main__":
    main()
