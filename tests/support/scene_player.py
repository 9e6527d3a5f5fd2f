"""A random player: builds, plays, begins again, edits, opens other levels, undoes, and is closed or killed.

All that stood on the screen is noted by the player; `unreachable` says what of it cannot be had back.
"""

import random

import pygame

from sandbox.editor.storage.scene_shelf import kept_scenes, scenes_in
from sandbox.level.reading.files import load_level, shipped_folder
from sandbox.physics.snapshot import state_hash
from sandbox.session.scene import read_scene

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
LEVELS = ("desk_toy", "rope", "newtons_cradle", "jelly_cube")
PARTS = (pygame.K_4, pygame.K_5, pygame.K_6, pygame.K_8)
# Frames that pass before something that takes the scene away, so that it has stood.
LOOK = 70


class Stood:
    """A scene as it stood on the screen: of which level, by which commands, when, and its hash."""

    def __init__(self, playback):
        scene = playback.present_scene()
        self.level, self.tick = scene.level, scene.tick
        self.deeds = [(line.tick, line.gesture, line.record) for line in scene.script]
        self.hash = state_hash(scene.state)


class ScenePlayer:
    """Plays in an app by a seed; stood: what was on the screen at each moment that took it away."""

    def __init__(self, driver, seed):
        self.driver, self.random = driver, random.Random(seed)
        self.stood = []
        self.hashes = {}

    @property
    def _play(self):
        return self.driver.app.play

    def go_on(self, deeds):
        for _ in range(deeds):
            self.random.choices(
                (self._drop, self._pull, self._cut, self._pin, self._wait, self._undo, self._redo, self._again,
                 self._edit, self._other_level, self._back, self._pause),
                (6, 3, 2, 1, 2, 3, 1, 2, 1, 2, 1, 1),
            )[0]()  # fmt: skip
            assert not self.driver.app.ui.has_sheet or self.driver.app.gallery is not None
            assert self._play is not None

    def _pixel(self):
        left, top, width, height = self._play.viewport
        return left + width * self.random.uniform(0.2, 0.8), top + height * self.random.uniform(0.2, 0.8)

    def _note(self):
        """What is taken away now has stood for a moment."""
        self.driver.pass_unseen(LOOK)
        if self._play.playback.scene() is not None and self._is_at_end:
            self.stood.append(Stood(self._play.playback))

    @property
    def _is_at_end(self):
        session = self._play.playback.session
        return session.tick == session.last_tick

    def _drop(self):
        self._before_change()
        self.driver.tap(self.random.choice(PARTS))
        self.driver.click(self._pixel())
        self.driver.tap(pygame.K_ESCAPE)

    def _before_change(self):
        """A change in the past takes away what followed."""
        if not self._is_at_end:
            self.driver.pass_unseen(LOOK)

    def _stroke(self, tool):
        self._before_change()
        self.driver.tap(tool)
        self.driver.press(self._pixel())
        for _ in range(3):
            self.driver.move(self._pixel())
        self.driver.release(self._pixel())
        self.driver.tap(pygame.K_ESCAPE)

    def _pull(self):
        self._stroke(pygame.K_1)

    def _cut(self):
        self._stroke(pygame.K_c)

    def _pin(self):
        self._stroke(pygame.K_p)

    def _wait(self):
        self.driver.pass_unseen(self.random.randrange(10, 90))

    def _pause(self):
        self.driver.tap(pygame.K_SPACE)

    def _undo(self):
        self._note()
        self.driver.key(pygame.K_z, CTRL)

    def _redo(self):
        self._note()
        self.driver.key(pygame.K_y, CTRL)

    def _again(self):
        self._note()
        self.driver.key(pygame.K_r)

    def _edit(self):
        self._note()
        self.driver.key(pygame.K_e)
        self.driver.key(pygame.K_e)

    def _other_level(self):
        self._note()
        self.driver.key(pygame.K_g)
        path = shipped_folder("levels") / f"{self.random.choice(LEVELS)}.json"
        self.driver.app.files.open_level(path, shipped=True)
        self.driver.frames(2)

    def _back(self):
        """Back in time, where there is any, and sometimes another future from there."""
        if self._play.playback.session.tick == 0:
            return
        self._note()
        for _ in range(self.random.randrange(1, 20)):
            self.driver.tap(pygame.K_COMMA)
        if self.random.random() < 0.5:
            self._drop()

    def close(self):
        """Close the window as a person does."""
        self._note()
        self.driver.app.close()

    def be_killed(self):
        """End with no chance to do anything; what was noted before has been written."""
        self._note()
        self.driver.app.scenes.shelf.settle()
        self.driver.app.screen = None
        self.driver.app.scenes.shelf._writer._queued.clear()
        self.driver.app.close()


def unreachable(stood, documents):
    """What stood and is in no scene that was kept or saved, neither as it stands nor by going back in time."""
    kept = [read_scene(path)[0] for path in [*kept_scenes(), *scenes_in(documents)]]
    plain = [(scene, [(line.tick, line.gesture, line.record) for line in scene.script]) for scene in kept]
    return [each for each in stood if not any(_has(scene, deeds, each) for scene, deeds in plain)]


def _has(scene, deeds, stood):
    if deeds != stood.deeds or scene.level != stood.level:
        return False
    if scene.tick == stood.tick:
        return state_hash(scene.state) == stood.hash
    session = scene.session()
    if scene.tick > stood.tick:
        session.seek(stood.tick)
    else:
        # The run was killed, or went on, since it was kept last.
        assert stood.tick - scene.tick <= 60 * 3
        while session.tick < stood.tick:
            session.advance()
    return state_hash(session.world) == stood.hash


def first_level(seed):
    """The level that a player begins with."""
    return load_level(LEVELS[seed % len(LEVELS)])
