"""Processes that tests talk to: a master, nodes, and a puppet node that publishes and listens on demand."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil

#: Seconds that a slow machine may take; a test that has its answer goes on at once.
PATIENCE = 90.0

HERE = Path(__file__).parent


def free_port(kind=socket.SOCK_STREAM, among=range(10_000, 32_000)):
    """Return a port of the loopback interface that nobody uses, below those that the kernel gives to connections.

    A master that is started again finds its port free: no connection was given it meanwhile.
    """
    for port in random.sample(among, len(among)):
        with socket.socket(type=kind) as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise AssertionError("no port is free")


def wait_for(condition, what):
    """Wait until a condition gives something; return it."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"waited {PATIENCE:.0f} s for {what}")


def stop_all(processes):
    """End programs, the latest first, whatever happens while one of them ends."""
    with contextlib.ExitStack() as stack:
        for process in processes:
            stack.callback(process.kill)


class Process:
    """A program that runs beside the test, its output in memory."""

    def __init__(self, command, env, cwd=None):
        self.popen = subprocess.Popen(
            command,
            env=env,
            cwd=cwd,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            bufsize=1,
            start_new_session=True,
        )
        self.command = " ".join(command)
        self.lines = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.popen.stdout:
            self.lines.append(line)
            self.on_line(line)

    def on_line(self, line):
        """Take a line of output."""

    @property
    def output(self):
        """All that was printed so far."""
        return "".join(self.lines)

    def wait_for_output(self, text):
        """Wait until the program has printed a text."""
        wait_for(lambda: text in self.output or self._ended(text), f"{text!r} in the output")

    def _ended(self, text):
        if self.popen.poll() is not None:
            self._reader.join(PATIENCE)
            assert text in self.output, f"the program ended without {text!r}:\n{self.output}"
        return False

    def stop(self, how=signal.SIGINT):
        """End the program; return its exit code."""
        self.popen.stdin.close()
        started = self._descendants()
        if self.popen.poll() is None:
            os.killpg(self.popen.pid, how)
            try:
                self.popen.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                os.killpg(self.popen.pid, signal.SIGKILL)
                self.popen.wait(PATIENCE)
        # What it started may hold its output open: rosbag still closes its file, and the nodes of roslaunch, each
        # in a session of its own, outlive it when it is killed.
        if how != signal.SIGKILL:
            self._reader.join(PATIENCE)
        for process in started:
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        self._reader.join(PATIENCE)
        assert not self._reader.is_alive(), f"somebody still holds the output of {self.command}"
        self.popen.stdout.close()
        return self.popen.returncode

    def kill(self):
        """End the program at once, and show what it printed: pytest tells it of a test that failed."""
        self.stop(signal.SIGKILL)
        print(f"---- {self.command}\n{self.output[-20_000:]}")

    def _descendants(self):
        try:
            return psutil.Process(self.popen.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            return []


class Puppet(Process):
    """A node of its own that does what it is told, a JSON object a line, and says what it hears."""

    def __init__(self, script, env, *args):
        self.events = []
        self._answers = queue.Queue()
        super().__init__([env.get("RTAMT_PYTHON", sys.executable), str(HERE / script), *args], env)
        self._answer("its start")

    def on_line(self, line):
        """Take an answer or a message."""
        if not line.startswith("{"):
            return
        event = json.loads(line)
        if event["event"] == "message":
            self.events.append(event)
        else:
            self._answers.put(event)

    def ask(self, **command):
        """Tell the puppet what to do; return its answer when it is done."""
        self.popen.stdin.write(json.dumps(command) + "\n")
        return self._answer(command)

    def _answer(self, to):
        try:
            return self._answers.get(timeout=PATIENCE)
        except queue.Empty:
            self.kill()
            raise AssertionError(f"no answer to {to}") from None

    def messages(self, topic):
        """Return what came on a topic so far."""
        return [event["data"] for event in self.events if event["topic"] == topic]

    def wait_for(self, topic, condition=bool, what=None):
        """Wait until what came on a topic fulfils a condition; return it."""
        wait_for(lambda: condition(self.messages(topic)), f"{what or 'a message'} on {topic}")
        return self.messages(topic)
