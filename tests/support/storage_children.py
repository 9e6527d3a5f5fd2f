"""What other processes do to files while the tests look on, or kill them."""

import multiprocessing
import os
import time

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.placing import add_particle
from sandbox.editor.history import History
from sandbox.editor.storage.autosave import Autosave
from sandbox.editor.storage.level_file import LevelFile
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.writing import write_over

NIGHTLY = os.environ.get("SANDBOX_NIGHTLY") == "1"

# Processes that start in milliseconds, with everything imported and no thread of the tests in them.
_processes = multiprocessing.get_context("forkserver") if hasattr(os, "fork") else multiprocessing.get_context("spawn")
if hasattr(os, "fork"):
    _processes.set_forkserver_preload(
        ["sandbox.editor.storage.autosave", "sandbox.editor.edits.placing", "sandbox.editor.history"]
    )


def named(name, count=3):
    """A level of that name with loose particles."""
    particles = tuple(ParticleDef(id=f"p{number}", position=(number / 7, 0.0)) for number in range(count))
    return Level(format="spring-sandbox/level", version=4, name=name, particles=particles)


class Child:
    """A process that runs one of the functions below and tells what it does through a pipe."""

    def __init__(self, work, *arguments):
        self.pipe, theirs = _processes.Pipe()
        self.process = _processes.Process(target=work, args=(theirs, *arguments), daemon=True)
        self.process.start()
        theirs.close()

    def hear(self):
        """What it says next. Raises EOFError where it has ended."""
        return self.pipe.recv()

    def heard(self):
        """All that it has said by its end."""
        said = []
        try:
            while True:
                said.append(self.pipe.recv())
        except EOFError:
            return said

    def kill(self, after=0.0):
        """Kill it at once, or some seconds from now; it gets no chance to do anything."""
        self.process.join(after)
        assert self.process.exitcode is None
        self.process.kill()
        self.process.join()


def hold(pipe, path, folder):
    """Have a level open until killed."""
    opened, _ = LevelFile.open(path, folder)
    pipe.send(os.getpid())
    pipe.recv()
    opened.close()


def save_forever(pipe, path, folder, levels):
    """Save levels in turn as the editor does."""
    opened = LevelFile(folder)
    opened.save_as(levels[0], path, replace=True)
    pipe.send("saved")
    while True:
        for level in levels:
            opened.save(level, replace=True)


def write_forever(pipe, path, texts, replaceable):
    """Write texts in turn and do nothing else, in place where files cannot be replaced."""
    if not replaceable:
        os.replace = _refused
    write_over(path, texts[0])
    pipe.send("saved")
    while True:
        for text in texts:
            write_over(path, text)


def _refused(*_):
    raise PermissionError(1, "Operation not permitted")


def edit_forever(pipe, folder, file, interval):
    """Add a particle every interval [s], and tell the number of each and when it was noted."""
    autosave = Autosave(folder)
    history = History(Document(empty_level()))
    number = 0
    while True:
        history.apply("Add particle", add_particle(history.document, ParticleDef(id="p", position=(number / 7, 1.0))))
        autosave.note(history.document.level, file, f"edit {number}")
        pipe.send((number, time.monotonic()))
        number += 1
        time.sleep(interval)
