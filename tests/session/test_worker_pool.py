"""Workers end with the process that they work for, whatever ends it."""

import signal
import subprocess
import sys

import pytest

# Both workers do something for ever; they hold what is printed open, so that its end is theirs.
WORKING = """
import os, sys
from sandbox.session.worker_pool import interrupts_ignored, worker_pool

def work(number):
    print("at work", flush=True)
    while True:
        pass

if __name__ == "__main__":
    with worker_pool(2) as workers:
        with interrupts_ignored():
            waiting = [workers.submit(work, number) for number in range(2)]
        waiting[0].result()
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL, signal.SIGINT], ids=lambda number: number.name)
def test_no_worker_outlives_its_parent(number, tmp_path):
    program = tmp_path / "working.py"
    program.write_text(WORKING)
    parent = subprocess.Popen([sys.executable, program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert [parent.stdout.readline() for _ in range(2)] == ["at work\n"] * 2
    parent.send_signal(number)
    left, told = parent.communicate()
    assert left == "" and parent.returncode != 0
    if number == signal.SIGTERM:
        assert parent.returncode == 128 + number and told == ""
