"""Live graphs: what is measured, kept within bounds and drawn; files hold what is shown; hidden they do nothing."""

import csv

import numpy as np
import pygame
import pytest

from sandbox.app.graphs.chart import Chart, GraphLine, nice_step, number_text
from sandbox.app.graphs.graph_dock import MEASURES, MOST_NAMES, Track
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.snapshot import state_hash
from sandbox.session.session import Session
from tests.app.conftest import small_level


@pytest.fixture
def graphs(driver):
    """The graphs of the small level, shown for 20 frames of motion."""
    driver.world.velocity[2] = (3.0, 2.0)
    driver.key(pygame.K_F8)
    driver.frames(20)
    return driver.app.play.graphs


def values(graphs, name):
    graphs.show(name)
    return {line.name: line.values for line in graphs.lines()}


def test_energies_strain_and_times_are_those_of_the_run(driver, graphs):
    energies = values(graphs, "energy")
    assert energies["total"][-1] == pytest.approx(total_energy(driver.world))
    assert energies["motion"] + energies["springs"] + energies["gravity"] == pytest.approx(energies["total"])
    strains = values(graphs, "strain")
    assert strains["most stretched"].max() > 0.1 > 0.0 > strains["most squeezed"].min()
    assert np.nanmin(values(graphs, "time")["one tick"]) > 0.0
    assert values(graphs, "torque") == {} and MEASURES["torque"].hint


def test_a_particle_under_the_mouse_is_followed_and_again_no_longer(driver, graphs):
    slot = driver.world.particle_slot("rope.2")
    driver.playback.clock.paused = True
    driver.move(driver.pixel_of("rope.2"))
    driver.frames(1)
    driver.stage._hovered = slot
    driver.app.act("pick")
    assert graphs.picked == [slot] and graphs.shown == "speed"
    driver.playback.clock.paused = False
    driver.frames(3)
    assert values(graphs, "speed")["rope.2"][-1] == pytest.approx(np.hypot(*driver.world.velocity[slot]))
    assert values(graphs, "place")["rope.2 x"][-1] == pytest.approx(driver.world.position[slot, 0])
    driver.stage._hovered = slot
    driver.app.act("pick")
    assert graphs.picked == []


def test_the_table_holds_what_is_shown_and_the_picture_shows_it(driver, graphs, documents):
    driver.click_widget(next(button for button in driver.app.ui.buttons() if button.text == "CSV"))
    driver.click_widget(next(button for button in driver.app.ui.buttons() if button.text == "PNG"))
    (table,) = documents.glob("*.csv")
    rows = list(csv.reader(table.read_text().splitlines()))
    assert rows[0] == ["tick", "time [s]", "total [J]", "motion [J]", "springs [J]", "gravity [J]"]
    ticks = [int(row[0]) for row in rows[1:]]
    assert len(ticks) > 15 and ticks == sorted(set(ticks))
    assert all(float(row[1]) == pytest.approx(int(row[0]) / 60, abs=1e-5) for row in rows[1:])
    (picture,) = (documents.parent / "pictures").rglob("*.png")
    pixels = pygame.surfarray.array3d(pygame.image.load(picture))
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 20


def test_pausing_keeps_the_graph_and_going_back_and_on_writes_no_tick_twice(driver, graphs):
    driver.playback.clock.paused = True
    driver.frames(1)
    before = [line.values.copy() for line in graphs.lines()]
    driver.frames(5)
    assert all(np.array_equal(one, line.values) for one, line in zip(before, graphs.lines(), strict=True))
    driver.playback.seek(driver.playback.session.tick - 10)
    driver.frames(1)
    assert len(graphs.lines()[0].values) == len(before[0])
    driver.playback.clock.paused = False
    driver.frames(15)
    seconds = graphs.lines()[0].seconds
    assert np.all(np.diff(seconds) > 0.0) and round(seconds[-1] * 60) == driver.playback.session.tick


def test_hidden_nothing_is_measured_and_shown_no_bit_of_the_run_changes(driver):
    alone = Session(small_level())
    for name in (*MEASURES, ""):
        driver.app.act("graphs")
        if name and driver.app.play.graphs.is_shown:
            driver.app.play.graphs.show(name)
        driver.frames(2)
    driver.app.play.graphs.is_shown = False
    driver.app.play.graphs._tracks.clear()
    driver.frames(3)
    assert not driver.app.play.graphs._tracks
    while alone.tick < driver.playback.session.tick:
        alone.advance()
    assert state_hash(alone.world) == state_hash(driver.world)


@pytest.mark.parametrize("size", [(640, 480), (1280, 720)])
def test_graphs_and_world_share_the_window_with_nothing_cut(driver, size):
    driver.app.display.window.size = size
    driver.key(pygame.K_F8)
    driver.frames(2)
    screen = driver.app.play
    world, chart = pygame.Rect(screen.viewport), screen.graphs._back
    assert world.bottom == chart.top and world.height > 150 and screen.graphs._place.height > 90
    right = max(button.rect.right for button in screen.graphs._tabs.buttons.values())
    span = next(button for button in driver.app.ui.buttons() if button.text == "10 s")
    assert right <= span.rect.left and chart.contains(screen.graphs._place)


def test_where_there_is_no_room_for_tabs_a_button_asks(driver):
    driver.app.display.window.size = (640, 480)
    driver.key(pygame.K_F8)
    driver.app.act("panel")
    driver.frames(2)
    graphs = driver.app.play.graphs
    assert graphs._tabs is None
    driver.click_widget(graphs._one)
    driver.choose("Strain")
    driver.frames(2)
    assert graphs.shown == "strain" and graphs._one.text == "Strain"


def test_two_runs_have_the_colours_of_their_quantities_and_dashes_of_their_own(driver):
    driver.key(pygame.K_F9)
    driver.key(pygame.K_F8)
    driver.frames(5)
    lines = {line.name: line for line in driver.app.play.graphs.lines()}
    assert set(lines) == {"A total", "A motion", "B total", "B motion"}
    assert lines["A total"].colour == lines["B total"].colour != lines["A motion"].colour
    assert lines["A total"].dashes != lines["B total"].dashes


def test_a_track_forgets_the_oldest_and_never_grows():
    track = Track(kept=50)
    for tick in range(1000):
        track.add(tick, {"a": tick, f"name {tick % 30}": 1.0})
    ticks, found = track.between(0, 2000)
    assert 50 <= len(ticks) <= 100 and ticks[-1] == 999
    assert len(track._values) <= MOST_NAMES and track.last_tick == 999
    track.forget_from(990)
    assert track.last_tick == 989 and len(found) <= MOST_NAMES


def drawn(lines, **options):
    surface = pygame.Surface((400, 160), 0, 32)
    Chart(surface, surface.get_rect(), 1.0).draw(lines, (0.0, 10.0), "J", **options)
    return pygame.surfarray.array3d(surface).astype(int)


def test_lines_are_seen_whatever_values_they_have(driver):
    seconds = np.linspace(0.0, 10.0, 4000)
    empty = drawn([], hint="nothing")
    for wild in (np.sin(seconds), np.full(4000, np.nan), np.full(4000, 1e300), np.where(seconds < 5, np.inf, 2.0)):
        picture = drawn([GraphLine("a", seconds, wild, 0, 0), GraphLine("b", seconds, np.cos(seconds), 1, 1)])
        assert (np.abs(picture - empty).max(axis=2) > 40).sum() > 300
    dashed = [drawn([GraphLine("a", seconds, np.sin(seconds), 0, style)]) for style in (0, 2)]
    assert (dashed[0] != dashed[1]).any(axis=2).sum() > 100
    line = [GraphLine("a", seconds, np.sin(seconds), 0, 0)]
    assert (drawn(line, cursor=200.0) != drawn(line)).any(axis=2).sum() > 500


def test_scales_have_round_steps_and_as_many_digits_as_these():
    assert [nice_step(span, 5) for span in (1.0, 9.0, 11.0, 26.0)] == pytest.approx([0.2, 2.0, 5.0, 10.0])
    assert nice_step(0.0, 5) == nice_step(np.nan, 5) == 1.0
    assert number_text(0.30000000000000004, 0.1) == "0.3"
    assert number_text(1500.0, 500.0) == "1,500" and number_text(-0.0, 1.0) == "0"
    assert number_text(0.0, 5e-10) == "0"
