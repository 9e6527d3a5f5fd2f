"""Steps one world with everything in it and prints its hash at each tick; run in processes of their own.

Some of its springs yield and break.

python kernel_script.py SOLVER SUBSTEPS[,SUBSTEPS..] TICKS
"""

import sys
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))


def busy_world(solver: str, substeps: int):
    """A mesh with diagonals of unequal masses, Hooke springs, pins, a coincident pair and a free particle.

    Some of its cells keep an area, narrow and wide, and some of its rows an angle.
    """
    import numpy as np

    from sandbox.physics.breaking import StrainLimits
    from sandbox.physics.constraints import AREA, BEND
    from sandbox.physics.driving import Actuators, Hydraulics, Motors, Muscles
    from sandbox.physics.marks import LAW_HOOKE
    from sandbox.physics.settings import WorldSettings
    from sandbox.physics.world import World

    settings = WorldSettings(
        (0.3, -9.81), substeps=substeps, solver=solver, iterations=6, warm_start=0.5, wind=(3.0, 0.5), drag=0.4
    )
    world = World(settings)
    side = 6
    points = [(0.5 * x, 0.45 * y) for y in range(side) for x in range(side)]
    masses = [0.1 + 0.37 * k * k for k in range(side * side)]
    pinned = [k in (side * (side - 1), side * side - 1) for k in range(side * side)]
    scale = [1.0 - 0.05 * k for k in range(side * side)]
    world.add_particles(
        [f"net.{k}" for k in range(side * side)], points, mass=masses, pinned=pinned, gravity_scale=scale
    )
    pairs = []
    for k in range(side * side):
        right, up = k % side < side - 1, k // side < side - 1
        pairs += [(k, k + 1)] * right + [(k, k + side)] * up
        pairs += [(k, k + side + 1), (k + 1, k + side)] * (right and up)
    names = [f"net:{k}" for k in range(len(pairs))]
    first, second = zip(*pairs, strict=True)
    world.add_springs(names, first, second, stiffness=0.09, damping=0.13)
    world.change("law", LAW_HOOKE, slice(5, 9))
    world.hooke_stiffness[5:9], world.hooke_damping[5:9] = 40.0, 0.3
    pair = world.add_particles(["a", "b", "free"], [(4, 4), (4, 4), (5, 5)], velocity=[(0, 0), (0.1, -0.2), (1, 2)])
    world.add_springs([":0", ":1"], [pair, pair], [pair + 1, pair + 1], rest_length=[0.3, 0.0], stiffness=0.2)
    cells = [k for k in range(side * (side - 1)) if k % side < side - 1 and k % 3 == 0]
    world.add_constraints(AREA, [(k, k + 1, k + side) for k in cells], stiffness=0.05, damping=0.07)
    world.add_constraints(AREA, [(0, 1, 2, 8, 14, 13, 12, 6)], inflation=1.3, stiffness=0.04, damping=0.06)
    world.add_constraints(BEND, [(k, k + 1, k + 2) for k in range(18, 22)], stiffness=0.05, damping=0.02, material=-1)
    world.change("lowest_mode", 0.07, slice(20, 60))
    world.change("constraint_lowest_mode", 0.07, slice(2, None))
    world.limits = StrainLimits(*np.array([[0.6], [0.5], [0.15], [0.2]]))
    limited = np.array([np.inf, 15.0])
    muscles = Muscles(np.array([3, 30]), np.array([0.3, 0.2]), np.array([7, 12]), np.array([0.0, 0.3]), limited)
    hydraulics = Hydraulics(
        np.array([40]), np.array([0.2]), np.array([0.9]), np.array([1.7]), np.array([1]), np.array([25.0])
    )
    rim = np.array([8, 9, 13, 15, 19, 20, 21])
    motors = Motors(np.array([14]), np.array([5.0]), np.array([90.0]), np.array([0]), np.array([0, 7]), rim)
    world.fit(Actuators(("motor", "jack"), muscles, hydraulics, motors), [0.7, 1.0])
    world.reserve_grabs()
    return world


def touching_world(solver: str, substeps: int):
    """Discs that fall on a mesh whose springs are edges, between terrain and walls; jellies that are in each other.

    The discs turn, but for one; two of them are shot at each other. Some of the edges and of the terrain are belts.
    """
    from sandbox.physics.marks import ALL_GROUPS, LINE
    from sandbox.physics.terrain import Chain, make_terrain
    from tests.support.contact_scenes import add_jelly

    world = busy_world(solver, substeps)
    world.change("edge", LINE)
    for name, value in (("group", 2), ("collides", ALL_GROUPS), ("owner", 1)):
        world.change(name, value, slice(36))
    names, points = [f"disc.{k}" for k in range(6)], [(0.3 + 0.41 * k, 2.9 + 0.2 * (k % 2)) for k in range(6)]
    world.add_particles(
        names, points, radius=0.15, friction=0.4, restitution=[0.6, 0.0] * 3, group=2, collides=ALL_GROUPS,
        velocity=(1.5, -9.0), gravity_scale=2.0, spin=[3.0 * k for k in range(6)], rolls=[k != 2 for k in range(6)],
        rolling=[0.01 * k for k in range(6)],
    )  # fmt: skip
    world.friction[:36] = 0.3
    world.add_particles(
        ["shot.0", "shot.1", "shot.2"], [(-1.5, 8.0), (4.5, 8.05), (1.2, 7.6)], radius=[0.15, 0.1, 0.2], friction=0.5,
        restitution=0.8, group=2, collides=ALL_GROUPS, velocity=[(40.0, 0.0), (-40.0, 0.0), (0.0, 20.0)],
    )  # fmt: skip
    for place in ((3.0, 5.0), (3.12, 5.05), (1.0, 1.0)):
        add_jelly(world, place, size=(0.2, 0.2), angle=0.3, stiffness=0.2, damping=0.4)
    world.change("belt", 0.8, slice(10))
    bowl = Chain([(-1.0, -0.6), (3.5, -1.5), (3.5, -0.2), (1.2, -0.9)], "solid", belt=2.0)
    line = Chain([(-0.5, 2.0), (-0.6, 0.5)], restitution=1.0, belt=-1.0)
    world.terrain = make_terrain([bowl, line, Chain([(-2.0, -2.0), (5.0, -2.0), (5.0, 9.0), (-2.0, 9.0)], "hollow")])
    return world


def touches(advance, solver: str, substeps: int, ticks: int):
    """Hash after each tick of a world in which things touch."""
    from sandbox.physics.snapshot import state_hash

    world, met = touching_world(solver, substeps), 0
    for _ in range(ticks):
        advance(world)
        met += len(world.contact_particle)
        yield state_hash(world)
    assert met > 40


def hashes(advance, solver: str, substeps: int, ticks: int):
    """Hash of the state after each tick of a script of hands, pins, cuts and sliders."""
    from sandbox.physics.snapshot import state_hash

    world = busy_world(solver, substeps)
    # What is one body is gripped by a hand that reaches far.
    world.change("owner", 1, slice(36))
    for tick in range(ticks):
        if tick % 10 == 2:
            world.hold(tick // 10 % 3, 7 + tick % 20, (1.0, 1.5), 60.0 + tick, 0.9 * (tick // 10 % 2))
        if tick % 10 > 2:
            world.move_grab(tick // 10 % 3, (1.0 + 0.07 * (tick % 10), 1.5 - 0.031 * tick))
        if tick % 10 == 9:
            world.release(tick // 10 % 3)
        if tick == 13:
            world.pin(15)
        if tick == 31:
            world.unpin(15)
            # What broke before cannot be cut.
            world.cut([s for s in (20, 21) if world.spring_active[s]])
        if tick == 27:
            world.drive(1, -0.3)
        if tick == 29:
            world.velocity[14] = (-70.0, -50.0)  # over its triangles, were those not held
        if tick == 24:
            world.set_coefficients(0.11, 0.05, None)
        advance(world)
        yield state_hash(world)


def swings(advance, solver: str, substeps: int, ticks: int):
    """Hash after each tick of a rope of unequal masses."""
    import numpy as np

    from sandbox.physics.settings import WorldSettings
    from sandbox.physics.snapshot import state_hash
    from sandbox.physics.world import World

    world, links = World(WorldSettings((0.3, -9.81), substeps=substeps, solver=solver)), np.arange(9)
    points = np.column_stack([0.4 * np.arange(10), np.zeros(10)])
    names = [f"rope.{k}" for k in range(10)]
    world.add_particles(names, points, mass=0.1 + 0.37 * np.arange(10), pinned=[True] + [False] * 9)
    world.add_springs([f"rope:{k}" for k in links], links, links + 1, stiffness=0.2, damping=0.1)
    for _ in range(ticks):
        advance(world)
        yield state_hash(world)


def modes():
    """The lowest modes of some forms, and Cs and Cd or what is nearest to them, as text that shows every bit."""
    import numpy as np

    from sandbox.physics.keeping.equipment import Firmness, StiffForm
    from sandbox.physics.softness.firmness import FirmnessRange, lowest_mode_of

    generator = np.random.default_rng(1)
    for count in (4, 9, 30):
        points, mass = generator.uniform(0.0, 3.0, (count, 2)), generator.uniform(0.1, 9.0, count)
        pairs = np.array([(a, b) for a in range(count) for b in range(a) if a - b < 4])
        corners = np.array([(k, k + 1, k + 2) for k in range(count - 2)])
        mode = lowest_mode_of(StiffForm(points, mass, pairs, corners, corners[::2]))
        reach, found = FirmnessRange(mode, generator.uniform(0.1, 3.0), 9.81, 1.0 / 60.0), ""
        for asked in (Firmness(sag=0.1), Firmness(sag=1e-6), Firmness(hz=2.0), Firmness(hz=40.0, ratio=0.1)):
            nearest = reach.nearest(asked)
            found += f" {nearest} {[value.hex() for value in reach.coefficients(nearest)]}"
        yield mode.hex() + found


def blow_up(advance, solver: str, ticks: int):
    """Hash after each tick of a mistuned Hooke spring on its way to inf and NaN."""
    from sandbox.physics.snapshot import state_hash

    world = busy_world(solver, 1)
    world.hooke_stiffness[5:9] = 1e9
    for _ in range(ticks):
        advance(world)
        yield state_hash(world)


if __name__ == "__main__":
    warnings.simplefilter("error")
    chosen, all_substeps, ticks = sys.argv[1:]
    from sandbox.physics.jit import way
    from sandbox.physics.step import step

    for number, substeps in enumerate(all_substeps.split(",")):
        print(way())
        given = step, chosen, substeps if substeps == "auto" else int(substeps), int(ticks)
        print("\n".join(hashes(*given)))
        print("\n".join(touches(*given)))
        if number == 0:
            print("\n".join(modes()))
            print("\n".join(blow_up(step, chosen, 2 * int(ticks))))
        print("\n".join(swings(*given)))
