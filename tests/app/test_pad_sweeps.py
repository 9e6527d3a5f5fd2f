"""What runs of the level have measured, behind the pad: made by children, kept, stopped, opened from a table."""

import numpy as np
import pygame
import pytest

import sandbox.app.panel.sweeps.pad_sweeps as pad_sweeps
from sandbox.app.draw.colours import show_theme
from sandbox.app.panel.sweeps.pad_sweeps import coarse_first
from sandbox.app.panel.sweeps.sweep_layer import BLOWN, FAILS, HOLDS, SweepLayer
from sandbox.cli import main
from sandbox.level.reading.files import write_level
from sandbox.session.commands import SetSolver
from tests.app.conftest import small_level

CHECKS = [{"name": "holds", "metric": "max_strain", "after": 0.1, "at_most": 1.0}]


@pytest.fixture
def padded(open_app, tmp_path, monkeypatch):
    """The app on the small level, with the pad in the panel, whose sweeps are small and short."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(pad_sweeps, "SIDE", 3)
    monkeypatch.setattr(pad_sweeps, "SECONDS", 0.1)
    driver = open_app(small_level(checks=CHECKS))
    driver.click_widget(driver.panel.ways.buttons["pad"])
    driver.frames(2)
    yield driver
    driver.app.play.leave()


def sweeps_of(driver):
    return driver.app.play.shape.sweeps


def wait(driver, until):
    """Let frames pass until something is so, which children at work bring about."""
    sweeps = sweeps_of(driver)
    for _ in range(1000):
        driver.pass_unseen()
        if until(sweeps):
            return
        if sweeps._finding is not None:
            sweeps._finding.result()
        elif sweeps._work is not None:
            for child in sweeps._work._children:
                child.wait()
    raise AssertionError("the sweep does not end")


def is_whole(sweeps):
    known, runs = sweeps.progress
    return sweeps._finding is None and known == runs > 0


def map_of(pad):
    """The map that is painted once the pad is seen."""
    assert pad.image is not None
    return pygame.image.tobytes(pad._map, "RGB")


def test_a_measure_is_found_by_children_shown_and_kept_for_the_next_time(padded, monkeypatch):
    pad = padded.panel.pad
    plain = map_of(pad)
    padded.panel.maps._choose("Largest strain")
    wait(padded, is_whole)
    assert sweeps_of(padded)._work is None and map_of(pad) != plain
    assert sweeps_of(padded).layer.values["max_strain"].shape == (3, 3)
    padded.panel.maps._choose("Theory")
    padded.frames(2)
    assert map_of(pad) == plain
    sweeps_of(padded)._thread.submit(lambda: None).result()
    monkeypatch.setattr(pad_sweeps, "BackgroundSweep", None)
    padded.panel.maps._choose("Blew up")
    wait(padded, is_whole)
    assert sweeps_of(padded).error is None and sweeps_of(padded).layer.text_at(0.01, 0.01) == "no"
    padded.move(pad.pixel_of(1e-5, 1e-5))
    assert pad._pointed is not None


def test_another_choice_or_another_solver_ends_the_children(padded, monkeypatch):
    monkeypatch.setattr(pad_sweeps, "SECONDS", 1e5)
    padded.panel.maps._choose("Settles after")
    wait(padded, lambda sweeps: sweeps._work is not None)
    children = sweeps_of(padded)._work._children
    padded.playback.submit(SetSolver(solver="direct"))
    wait(padded, lambda sweeps: sweeps._work is not None and sweeps._work._children is not children)
    assert all(child.wait() != 0 for child in children)
    assert sweeps_of(padded)._grid.level.settings.solver == "direct"
    children = sweeps_of(padded)._work._children
    padded.panel.maps._choose("Theory")
    assert all(child.wait() != 0 for child in children) and sweeps_of(padded)._work is None


def test_a_table_that_the_command_made_of_this_level_is_opened_and_one_of_another_is_refused(padded, tmp_path):
    for name, level in (("same", small_level(checks=CHECKS)), ("other", small_level())):
        write_level(level, tmp_path / f"{name}.json")
        grid = ["--cs", "0.1,0.2", "--cd", "0.5,1", "--solver", "direct,single_pass", "--processes", "1"]
        arguments = ["sweep", str(tmp_path / f"{name}.json"), *grid, "--seconds", "0.05", "--material", "rubber"]
        assert main([*arguments, "-o", str(tmp_path / f"{name}.csv")]) == 0
    padded.post(pygame.DROPFILE, file=str(tmp_path / "same.csv"))
    padded.frames(2)
    wait(padded, is_whole)
    layer = sweeps_of(padded).layer
    rubber = padded.world.material_names.index("rubber")
    assert padded.panel.material == rubber and layer.stiffness.tolist() == [0.1, 0.2] and layer.figure == "settle_time"
    assert padded.app.files.open_path(tmp_path / "same.csv") and not padded.app.files.open_path(tmp_path / "other.csv")
    (tmp_path / "none.csv").write_text("a,b\n")
    assert not padded.app.files.open_path(tmp_path / "none.csv")


def test_cells_tell_what_is_measured_what_is_missing_and_what_is_not_known():
    show_theme("dark")
    nothing = float("nan")
    blown, held = np.array([[0.0, 0.0], [1.0, nothing]]), np.array([[1.0, 0.0], [0.0, nothing]])
    values = {"settle_time": np.array([[1.0, nothing], [3.0, nothing]]), "blew_up": blown, "check: holds": held}
    layer = SweepLayer("settle_time", np.array([0.1, 0.2]), np.array([0.5, 1.0]), values)
    told = [layer.text_at(cs, cd) for cd in (0.5, 1.0) for cs in (0.1, 0.2)]
    assert told == ["1 s", "never settles", "blew up", "not run yet"]
    assert layer.text_at(0.9, 0.5) == "outside the sweep" and layer.scale == (0.0, 1.0, False)
    pixels = layer.pixels(layer.stiffness, layer.damping, np.ones((2, 2), dtype=bool))
    assert tuple(pixels[0, 1]) == BLOWN and len({tuple(pixel) for row in pixels for pixel in row}) == 4
    check = SweepLayer("check: holds", layer.stiffness, layer.damping, values)
    assert check.text_at(0.1, 0.5) == "holds" and check.colours(np.array([0.0, 1.0])).tolist() == [[*FAILS], [*HOLDS]]


def test_points_far_apart_are_run_first():
    order = coarse_first(5)
    assert sorted(order) == list(range(25)) and order[:4] == [0, 4, 20, 24] and set(order[4:9]) == {2, 10, 12, 14, 22}
