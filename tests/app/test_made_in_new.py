"""Make ten things in New by the pointer, as a stranger draws them: each works at the first try."""

import pygame
import pytest

from tests.support.made_in_play import SIZE, THINGS, Hands

# The strokes that each takes, buttons included.
STROKES = {
    "cart": 10, "swing": 7, "see_saw": 8, "mill": 8, "catapult": 10, "bridge": 13, "chain": 10, "house": 7, "boat": 10,
    "walker": 11,
}  # fmt: skip
AHEAD = "d"
pytestmark = pytest.mark.slow


@pytest.fixture
def make(open_app):
    def made(name, is_finger=False):
        driver = open_app()
        driver.app.documents.play_new()
        driver.frames(3)
        hands = Hands(driver, is_finger)
        THINGS[name](hands)
        assert hands.strokes == STROKES[name] and not driver.playback.clock.paused
        return driver

    return made


def run(driver, frames):
    """Let frames pass; nothing was refused until then."""
    driver.pass_unseen(frames)
    assert not driver.playback.session.messages


def middle(driver, name):
    """The middle of a body [m], in the measure that it was drawn in."""
    world = driver.world
    slots = [slot for slot, each in enumerate(world.particle_names) if each.startswith(f"{name}.")]
    return world.position[slots].mean(axis=0) / SIZE


def drive(driver, frames):
    driver.post(pygame.KEYDOWN, key=ord(AHEAD), mod=0, unicode=AHEAD, scancode=0)
    run(driver, frames)


@pytest.mark.parametrize("is_finger", [False, True], ids=["mouse", "finger"])
def test_a_cart_drives(make, is_finger):
    driver = make("cart", is_finger)
    run(driver, 60)
    start, height = middle(driver, "+1")
    drive(driver, 150)
    there = middle(driver, "+1")
    assert there[0] > start + 1.5 and abs(there[1] - height) < 0.1 and height > 0.4
    driver.post(pygame.KEYUP, key=ord(AHEAD), mod=0, unicode=AHEAD, scancode=0)
    for _ in range(9):
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert not driver.world.joined


@pytest.mark.parametrize("is_finger", [False, True], ids=["mouse", "finger"])
def test_a_swing_hangs_on_its_ropes_and_swings(make, is_finger):
    driver = make("swing", is_finger)
    run(driver, 120)
    seat = middle(driver, "+1")
    assert seat == pytest.approx((0.0, 1.2), abs=0.05)
    x, y = (SIZE * seat).tolist()
    driver.playback.session.do("push", position=[x, y], radius=2.0, impulse=[60.0, 0.0])
    swung = []
    for _ in range(20):
        run(driver, 10)
        swung.append(middle(driver, "+1")[0])
    assert min(swung) < -0.2 and max(swung) > 0.2


@pytest.mark.parametrize("is_finger", [False, True], ids=["mouse", "finger"])
def test_a_catapult_throws(make, is_finger):
    driver = make("catapult", is_finger)
    highest = 0.0
    for _ in range(60):
        run(driver, 4)
        highest = max(highest, middle(driver, "+3")[1])
    assert highest > 3.0 and middle(driver, "+1")[0] == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize("is_finger", [False, True], ids=["mouse", "finger"])
def test_a_mill_turns_and_its_tower_stands(make, is_finger):
    driver = make("mill", is_finger)
    run(driver, 60)
    tower, sails = middle(driver, "+1"), middle(driver, "+2")
    tip = driver.world.particle_slot("+2.0")
    seen = []
    drive(driver, 30)
    for _ in range(40):
        run(driver, 5)
        seen.append(driver.world.position[tip] / SIZE - middle(driver, "+2"))
    assert min(x for x, _ in seen) < -0.05 and max(x for x, _ in seen) > 0.05 and min(y for _, y in seen) < 0.0
    assert middle(driver, "+1") == pytest.approx(tower, abs=0.1)
    assert middle(driver, "+2") == pytest.approx(sails, abs=0.1)


def test_a_see_saw_tips_under_what_falls_on_it(make):
    driver = make("see_saw")
    run(driver, 60)
    plank = driver.world.position[[slot for slot, name in enumerate(driver.world.particle_names) if name[:3] == "+1."]]
    right, left = plank[plank[:, 0].argmax()], plank[plank[:, 0].argmin()]
    assert right[1] < left[1] - 0.5 and middle(driver, "+1") == pytest.approx((0.0, 1.2), abs=0.02)


def test_a_bridge_hangs_between_its_ends(make):
    driver = make("bridge")
    run(driver, 300)
    heights = [middle(driver, f"+{k}")[1] for k in (1, 2, 3, 4)]
    assert min(heights) > 1.0 and heights[0] > heights[1] and heights[3] > heights[2]


def test_a_chain_hangs_in_a_row(make):
    driver = make("chain")
    run(driver, 200)
    assert [middle(driver, f"+{k}")[1] for k in (1, 2, 3)] == pytest.approx([3.3, 2.3, 1.3], abs=0.1)


def test_a_house_stands(make):
    driver = make("house")
    before = [middle(driver, f"+{k}") for k in (1, 2, 3, 4)]
    run(driver, 200)
    for k, place in enumerate(before, 1):
        assert middle(driver, f"+{k}") == pytest.approx(place, abs=0.1)


def test_a_boat_keeps_its_mast_upright(make):
    driver = make("boat")
    run(driver, 200)
    hull, mast = middle(driver, "+1"), middle(driver, "+2")
    assert abs(mast[0] - hull[0]) < 0.1 and mast[1] > hull[1] + 0.8


def test_a_walker_walks(make):
    driver = make("walker")
    run(driver, 60)
    start = middle(driver, "+1")
    drive(driver, 200)
    there = middle(driver, "+1")
    assert there[0] > start[0] + 1.0 and there[1] > 0.5
