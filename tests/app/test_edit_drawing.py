"""Drawing in the editor: what the mouse or the keyboard draws is in the level, and undo takes it back."""

import math

import numpy as np
import pygame
import pytest

from sandbox.editor.tools.drawing_options import described
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.web import WebDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.physics.marks import NO_EDGE

CTRL = pygame.KMOD_CTRL


def test_a_rope_is_drawn_by_a_drag_with_a_ghost_before_the_release(edit):
    driver = edit()
    driver.key(pygame.K_r)
    driver.press(driver.at(-2, 1))
    driver.move(driver.at(1, 1))
    ghost = driver.editor.pointer_tool.ghost()
    assert [body.type for body in ghost.level.bodies] == ["rope"] and not driver.editor.document.level.bodies
    assert "3 m" in driver.editor.pointer_tool.measure
    driver.release(driver.at(1, 1))
    (rope,) = driver.editor.document.level.bodies
    assert isinstance(rope, RopeDef)
    assert rope.start == pytest.approx((-2, 1)) and rope.end == pytest.approx((1, 1))
    assert driver.editor.history.labels == ["New", "Draw rope"]


@pytest.mark.parametrize(
    ("key", "kind"),
    [
        (pygame.K_b, BridgeDef), (pygame.K_g, GirderDef), (pygame.K_w, WebDef), (pygame.K_j, JellyDef),
        (pygame.K_o, JellyDef), (pygame.K_q, WheelDef),
    ],
)  # fmt: skip
def test_every_body_is_drawn_by_its_key_and_a_drag(edit, key, kind):
    driver = edit()
    driver.key(key)
    driver.drag((-1, 0), (0, 1), (1, 1.5))
    (body,) = driver.editor.document.level.bodies
    assert isinstance(body, kind)
    before = driver.editor.history
    assert before.labels[-1] == f"Draw {body.type}"
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level.bodies == () and before.can_redo
    driver.key(pygame.K_y, CTRL)
    assert driver.editor.document.level.bodies == (body,)


def test_a_polygon_is_drawn_by_clicks_and_closed_by_enter(edit):
    driver = edit()
    driver.key(pygame.K_y)
    for x, y in ((-1, 0), (1, 0), (1, 2)):
        driver.click_at(x, y)
    driver.key(pygame.K_RETURN)
    (body,) = driver.editor.document.level.bodies
    assert len(body.shape.polygon) == 3


@pytest.mark.parametrize("key", [pygame.K_o, pygame.K_y])
def test_round_things_drawn_by_mouse_have_particles_on_their_outline_and_undo_takes_them_back(edit, key):
    driver = edit()
    driver.key(key)
    if key == pygame.K_o:
        driver.drag((0, 1), (0.5, 1), (1, 1))
    else:
        driver.drag(*stroke(0.0))
    (body,) = driver.editor.document.level.bodies
    assert body.mesh == "fitted"
    form = expansion(body).form
    border = np.unique(expansion(body).pairs[expansion(body).edges != NO_EDGE])
    middle, radius = ((0, 1), 1.0) if key == pygame.K_o else ((0.13, 1.21), 0.95)
    away = np.hypot(*(form[border] - middle).T)
    assert np.abs(away - radius).max() < 0.08
    assert len(border) >= 20
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level.bodies == ()
    driver.key(pygame.K_y, CTRL)
    assert driver.editor.document.level.bodies == (body,)


def stroke(overlap):
    """A circle by hand of radius 1 m about (0.13, 1.21), which goes on over its beginning and a little inward."""
    turns = [k / 40 for k in range(round(40 * (1 + overlap)) + 1)]
    return [
        (0.13 + (1 - 0.1 * turn) * math.cos(math.tau * turn), 1.21 + (1 - 0.1 * turn) * math.sin(math.tau * turn))
        for turn in turns
    ]


@pytest.mark.parametrize("overlap", [-0.02, 0.0, 0.1])
def test_a_stroke_by_hand_is_closed_where_it_meets_or_runs_over_its_beginning(edit, overlap):
    driver = edit()
    driver.key(pygame.K_y)
    driver.drag(*stroke(overlap))
    (body,) = driver.editor.document.level.bodies
    x, y = zip(*body.shape.polygon, strict=True)
    assert len(x) > 8
    assert (max(x) - min(x), max(y) - min(y)) == pytest.approx((2, 2), abs=0.2)


def test_backspace_takes_the_last_corner_back_and_deletes_nothing(edit):
    driver = edit()
    driver.key(pygame.K_y)
    for x, y in ((-1, 0), (1, 0), (1, 2), (2, 2)):
        driver.click_at(x, y)
    driver.key(pygame.K_BACKSPACE)
    driver.key(pygame.K_RETURN)
    (body,) = driver.editor.document.level.bodies
    assert len(body.shape.polygon) == 3
    driver.key(pygame.K_ESCAPE)
    driver.editor.select(frozenset(driver.editor.scene.items))
    driver.key(pygame.K_BACKSPACE)
    assert driver.editor.document.level.bodies == ()


def test_particles_and_a_spring_between_them_are_drawn_by_clicks(edit):
    driver = edit()
    driver.key(pygame.K_a)
    driver.click_at(-1, 0)
    driver.click_at(1, 0)
    driver.key(pygame.K_s)
    driver.drag((-1, 0), (0, 0), (1, 0))
    level = driver.editor.document.level
    assert [particle.position for particle in level.particles] == [(-1, 0), (1, 0)]
    (spring,) = level.springs
    assert {spring.a, spring.b} == {particle.id for particle in level.particles}


def test_a_rope_that_ends_on_a_particle_is_welded_to_it(edit):
    driver = edit()
    driver.key(pygame.K_a)
    driver.click_at(1, 0)
    driver.key(pygame.K_r)
    driver.drag((-2, 1), (0, 0.5), (1.02, 0.02))
    level = driver.editor.document.level
    assert len(level.welds) == 1
    assert level.bodies[0].end == pytest.approx((1, 0))
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level.welds == ()


def test_the_pin_tool_pins_a_particle_of_a_body_and_unpins_it(edit):
    driver = edit()
    driver.key(pygame.K_r)
    driver.drag((-2, 1), (0, 1), (2, 1))
    slot = driver.editor.scene.slot("rope.end")
    assert not driver.editor.scene.pinned[slot]
    driver.key(pygame.K_p)
    driver.click_at(2, 1)
    assert driver.editor.scene.pinned[slot]
    driver.click_at(2, 1)
    assert not driver.editor.scene.pinned[slot]


def test_alt_suspends_snapping_and_x_turns_it_off(edit):
    driver = edit()
    driver.key(pygame.K_a)
    grid = driver.editor.grid
    off = 0.37 * grid
    driver.click_at(off, off)
    driver.click_at(4 * grid + off, off, pygame.KMOD_ALT)
    driver.key(pygame.K_x)
    driver.click_at(8 * grid + off, off)
    first, second, third = (particle.position[0] / grid for particle in driver.editor.document.level.particles)
    assert first == pytest.approx(0.0)
    assert second == pytest.approx(4.37, abs=0.05) and third == pytest.approx(8.37, abs=0.05)


def test_options_in_the_row_change_what_is_drawn_next_and_a_wrong_one_is_said(edit):
    driver = edit()
    driver.key(pygame.K_r)
    fields = driver.editor.options.fields
    driver.fill(fields["segments"][0], "7")
    driver.drag((-2, 1), (0, 1), (2, 1))
    assert driver.editor.document.level.bodies[0].segments == 7
    driver.fill(fields["slack"][0], "much")
    assert any("not a number" in text for text in driver.notices)
    driver.fill(fields["segments"][0], "0")
    driver.drag((-2, 2), (0, 2), (2, 2))
    assert driver.editor.document.level.bodies[1].segments == 7


def test_the_wheel_over_an_option_and_the_arrows_in_it_step_its_value(edit):
    driver = edit()
    driver.key(pygame.K_a)
    mass = driver.editor.options.fields["mass"][0]
    zoom = driver.editor.camera.zoom
    driver.move(mass.rect.center)
    for _ in range(4):
        driver.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0)
    driver.frames()
    assert mass.typed == "20" and driver.editor.camera.zoom == zoom
    driver.app.ui.focus_on(mass)
    driver.type("70")
    driver.key(pygame.K_UP)
    assert mass.typed == "100"
    driver.key(pygame.K_ESCAPE)
    driver.click_at(0, 0)
    assert driver.editor.document.level.particles[0].mass == 100.0


def test_the_wheel_turned_before_the_next_frame_steps_the_option_that_the_mouse_has_reached(edit):
    driver = edit()
    driver.key(pygame.K_a)
    fields = driver.editor.options.fields
    mass, radius = fields["mass"][0], fields["radius"][0]
    driver.move(mass.rect.center)
    before = mass.typed, radius.typed
    driver.post(pygame.MOUSEMOTION, pos=radius.rect.center, rel=(0, 0), buttons=(0, 0, 0))
    driver.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0)
    driver.frames()
    assert mass.typed == before[0] and float(radius.typed) > float(before[1])


def test_the_material_of_what_is_drawn_is_chosen_from_a_menu(edit):
    driver = edit()
    driver.key(pygame.K_r)
    picker = driver.editor.options.pickers["material"]
    assert picker.shown.text == "steel"
    driver.click_widget(picker)
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    driver.frames()
    assert picker.shown.text == "rubber"
    driver.drag((-2, 1), (0, 1), (2, 1))
    assert driver.editor.document.level.bodies[0].material == "rubber"


def test_plus_and_minus_count_the_parts_while_drawing_and_zoom_otherwise(edit):
    driver = edit()
    driver.key(pygame.K_r)
    zoom = driver.editor.camera.zoom
    driver.press(driver.at(-2, 1))
    driver.move(driver.at(1, 1))
    links = (
        len(driver.editor.pointer_tool.ghost().level.bodies)
        and driver.editor.pointer_tool.ghost().level.bodies[0].segments
    )
    driver.key(pygame.K_EQUALS)
    assert driver.editor.pointer_tool.ghost().level.bodies[0].segments == links + 1
    assert driver.editor.camera.zoom == zoom
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_EQUALS)
    assert driver.editor.camera.zoom > zoom


def test_escape_gives_a_drawing_up_and_then_the_tool(edit):
    driver = edit()
    driver.key(pygame.K_r)
    driver.click_at(-2, 1)
    driver.move(driver.at(1, 1))
    driver.key(pygame.K_ESCAPE)
    assert driver.editor.pointer_tool.ghost() is None or not driver.editor.pointer_tool.drawing.under_way
    assert driver.editor.tool == "rope"
    driver.key(pygame.K_ESCAPE)
    assert driver.editor.tool == "select" and driver.editor.history.labels == ["New"]


def test_the_keyboard_alone_draws_a_rope(edit):
    driver = edit()
    driver.key(pygame.K_r)
    driver.move((5, 5))
    driver.key(pygame.K_RIGHT)
    start = driver.editor.cursor
    driver.key(pygame.K_RETURN)
    for _ in range(8):
        driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_RETURN)
    (rope,) = driver.editor.document.level.bodies
    assert rope.start == pytest.approx(start)
    assert rope.end == pytest.approx((start[0] + 8 * driver.editor.grid, start[1]))


def test_every_tool_has_a_button_in_the_palette(edit):
    driver = edit()
    for name, button in driver.editor.palette.tools.items():
        driver.click_widget(button)
        assert driver.editor.tool == name


@pytest.mark.parametrize("scale", [1.0, 1.6, 2.0])
@pytest.mark.parametrize("tool", ["rope", "bridge", "web", "wheel"])
def test_all_options_can_be_reached_at_every_scale_and_none_lies_beyond_the_window(edit, tool, scale):
    driver = edit()
    driver.app.scale = scale
    driver.editor.choose_tool(tool)
    driver.app.rebuild()
    driver.frames(2)
    options, reached, pages = driver.editor.options, [], 0
    names = list(described(driver.editor.pointer_tool.drawing.options))
    while not set(names) <= set(reached):
        shown = {name: field for name, (field,) in options.fields.items()} | options.buttons | options.pickers
        assert all(options.back.rect.contains(widget.rect) for widget in shown.values())
        lefts = sorted(widget.rect.left for widget in shown.values())
        rights = sorted(widget.rect.right for widget in shown.values())
        assert all(right < left for right, left in zip(rights, lefts[1:], strict=False))
        assert shown and not set(shown) & set(reached)
        assert options.more is None or rights[-1] < options.more.rect.left
        reached += shown
        pages += 1
        if len(reached) < len(names):
            driver.click_widget(options.more)
    assert (pages > 1) == (options.more is not None)
    assert scale == 1.0 or pages > 1


def test_the_options_that_come_next_are_reached_by_keyboard_too(edit):
    driver = edit()
    driver.app.scale = 1.6
    driver.editor.choose_tool("wheel")
    driver.app.rebuild()
    driver.frames(2)
    options = driver.editor.options
    first = set(options.fields)
    driver.app.ui.focus_on(options.more)
    driver.key(pygame.K_RETURN)
    assert set(options.fields).isdisjoint(first) and driver.app.ui.focus is options.more


def test_what_a_tool_refuses_is_said_in_whole_sentences(edit):
    driver = edit()
    driver.key(pygame.K_w, pygame.KMOD_SHIFT)
    driver.press(driver.at(-2, 1))
    driver.move(driver.at(2, 1))
    fault = "There is no muscle; select springs or bodies, and add one under Drive in Properties"
    assert driver.editor.pointer_tool.hint == fault
    driver.release(driver.at(2, 1))
    assert driver.notices == [f"{fault}."]
