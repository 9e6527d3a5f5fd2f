"""Shipped levels do what their texts say: what is cut falls, what is thrown hits, what is driven comes back."""

import math

import numpy as np
import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.jit import COMPILED
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")


def do(session, **command):
    """Carry out a command that must not be refused."""
    before = len(session.messages)
    session.submit(from_record(command, session.world), 1)
    session.apply_pending()
    assert not session.messages[before:]


def run(session, ticks):
    """Go on for some ticks."""
    for _ in range(ticks):
        session.advance()


def place(session, particle):
    """Where a particle is [m]."""
    return session.world.position[session.world.particle_slot(particle)].copy()


def broken(session):
    """How many springs of the level are gone."""
    return np.count_nonzero(~session.world.spring_active[: session.world.grab_spring])


def soften(session, material, stiffness):
    """Type another Cs of a material; Cd stays."""
    world = session.world
    damping = world.damping[world.material == world.material_names.index(material)][0]
    do(session, type="set_coefficients", material=material, stiffness=stiffness, damping=float(damping))


def choose(session, solver):
    """Choose a solver."""
    settings = session.world.settings
    do(session, type="set_solver", solver=solver, iterations=10, substeps=settings.substeps)


def test_the_deck_of_the_suspension_bridge_gives_and_comes_back():
    session = Session(load_level("suspension_bridge"))
    run(session, 120)
    level = place(session, "deck.22")[1]
    do(session, type="grab", grab=0, particle="deck.22", target=[0.0, -3.0])
    run(session, 60)
    assert place(session, "deck.22")[1] < level - 1.0
    do(session, type="release", grab=0)
    run(session, 240)
    assert place(session, "deck.22")[1] == pytest.approx(level, abs=0.1)


def test_the_deck_of_the_suspension_bridge_drops_where_its_cable_is_cut():
    session = Session(load_level("suspension_bridge"))
    run(session, 120)
    tower = place(session, "left tower.18")
    do(session, type="cut_springs", springs=["cable:6"])
    run(session, 240)
    assert place(session, "deck.10")[1] < -4.0
    assert place(session, "left tower.18") == pytest.approx(tower, abs=0.01)


def test_a_hanger_of_the_suspension_bridge_can_be_spared():
    session = Session(load_level("suspension_bridge"))
    run(session, 120)
    do(session, type="cut_springs", springs=[":7"])
    run(session, 240)
    assert place(session, "deck.22")[1] > -0.6


@pytest.mark.parametrize(("stiffness", "hits"), [(None, True), (0.2, False)])
def test_the_catapult_hits_the_castle_and_shoots_over_it_with_a_softer_thread(stiffness, hits):
    session = Session(load_level("catapult"))
    run(session, 30)
    if stiffness is not None:
        soften(session, "thread", stiffness)
    before = place(session, "brick 18.0")
    run(session, 30)
    do(session, type="set_drive", part=":0", value=1.0)
    farthest = 0.0
    for _ in range(160):
        session.advance()
        farthest = max(farthest, place(session, "ball")[0])
    moved = math.dist(place(session, "brick 18.0"), before)
    assert (moved > 1.0) == hits and (farthest < 16.0) == hits
    do(session, type="set_drive", part=":0", value=-1.0)
    run(session, 240)
    assert place(session, "arm.end")[0] == pytest.approx(-6.0, abs=0.1)


def swing(session):
    """Drag the ball under the bridge to a side, let go, and wait for some swings."""
    run(session, 120)
    do(session, type="grab", grab=0, particle="ball", target=[0.0, -4.0])
    for tick in range(1, 61):
        x = 4.0 * tick / 60
        do(session, type="move_grab", grab=0, target=[x, 1.0 - math.sqrt(25.0 - x * x)])
        session.advance()
    do(session, type="release", grab=0)
    run(session, 480)


def test_the_bridge_breaks_where_its_ball_swings_and_not_before():
    session = Session(load_level("breaking_bridge"))
    run(session, 300)
    assert broken(session) == 0
    swing(session)
    assert broken(session) > 4 and place(session, "deck.8")[1] < 0.0


def test_the_bridge_holds_the_swing_where_its_iron_is_stiff():
    session = Session(load_level("breaking_bridge"))
    do(session, type="set_coefficients", material="iron", stiffness=1.0, damping=1.0)
    swing(session)
    assert broken(session) == 0 and place(session, "deck.8")[1] > 1.9


@pytest.mark.parametrize(
    ("name", "end", "iterative", "pull"),
    [("girder", "girder.end", -1.0, (0.0, -2.0)), ("mast", "mast.62", 9.5, (-4.0, -2.0))],
)
def test_direct_holds_what_droops_with_iterative_and_brings_it_back(name, end, iterative, pull):
    session = Session(load_level(name))
    run(session, 120)
    x, y = place(session, end)
    do(session, type="grab", grab=0, particle=end, target=[x + pull[0], y + pull[1]])
    run(session, 60)
    assert math.dist(place(session, end), (x, y)) < 0.005
    do(session, type="release", grab=0)
    choose(session, "iterative")
    run(session, 300)
    assert place(session, end)[1] < iterative
    choose(session, "direct")
    run(session, 300)
    assert math.dist(place(session, end), (x, y)) < 0.01


def crossing(session, x):
    """Names of the springs of the deck that a vertical line crosses."""
    world = session.world
    ends = world.position[world.particle_a, 0], world.position[world.particle_b, 0]
    found = (np.minimum(*ends) < x) & (np.maximum(*ends) > x)
    return [world.spring_names[slot] for slot in np.flatnonzero(found[: world.grab_spring]).tolist()]


def test_the_truss_holds_with_a_bar_less_and_falls_where_it_is_cut_through():
    session = Session(load_level("truss_bridge"))
    run(session, 60)
    bars = crossing(session, 0.75)
    do(session, type="cut_springs", springs=bars[:1])
    run(session, 120)
    assert place(session, "load")[1] > -2.1
    do(session, type="cut_springs", springs=bars[1:])
    run(session, 240)
    assert place(session, "load")[1] < -4.0


def test_the_chain_of_the_wrecking_ball_stretches_less_with_more_iterations_and_not_at_all_with_direct():
    longest = []
    for solver, iterations in (("iterative", 5), ("iterative", 20), ("direct", 10)):
        session = Session(load_level("wrecking_ball"))
        do(session, type="set_solver", solver=solver, iterations=iterations, substeps=4)
        lengths = []
        for _ in range(240):
            session.advance()
            lengths.append(float(np.linalg.norm(place(session, "ball"))))
        longest.append(max(lengths) / 14.4)
        run(session, 240)
        assert place(session, "brick 17.0")[1] < -14.0  # the wall is down
    assert longest[0] > 1.06 > longest[1] > 1.01 > 1.001 > longest[2]


def test_two_balls_of_the_cradle_send_two_off():
    level = load_level("newtons_cradle")
    particles = list(level.particles)
    angle = math.radians(40.0)
    for index in (5, 6):
        x, y = particles[index - 5].position
        lifted = (x - 5.0 * math.sin(angle), y - 5.0 * math.cos(angle))
        particles[index] = particles[index].model_copy(update={"position": lifted})
    session = Session(level.model_copy(update={"particles": tuple(particles)}))
    first = {name: place(session, name)[0] for name in ("ball 3", "ball 4", "ball 5")}
    farthest = dict.fromkeys(first, 0.0)
    for _ in range(130):
        session.advance()
        for name, x in first.items():
            farthest[name] = max(farthest[name], place(session, name)[0] - x)
    assert farthest["ball 4"] > 1.0 and farthest["ball 5"] > 1.0 and farthest["ball 3"] < 0.1
