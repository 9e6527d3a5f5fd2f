"""Particles and springs are added to a running world, and named."""

from dataclasses import dataclass
from typing import Any

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.assembly.kits import join_loose
from sandbox.level.format.quantities import FrictionCoefficient, Length, Mass, Point, Share, Velocity
from sandbox.physics.commands.command import ADD_PARTICLE, ADD_SPRING
from sandbox.physics.kits.joining import KitError
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot

SAME_ENDS = "a spring joins two different particles, not {} to itself"


@dataclass(frozen=True)
class AddParticle(Command):
    """Add a particle at position [m], of mass [kg] and radius [m]; it is named +.0, +.1, ... in order of adding.

    velocity [m/s]; friction, restitution: None = as what says nothing in the level.
    """

    type = "add_particle"
    position: Point
    mass: Mass = 1.0
    radius: Length = 0.05
    pinned: bool = False
    velocity: Velocity | None = None
    friction: FrictionCoefficient | None = None
    restitution: Share | None = None

    def carry_out(self, world: LevelWorld, giver: int) -> None:
        (x, y), (vx, vy) = self.position, self.velocity or (0.0, 0.0)
        surface = {"friction": self.friction, "restitution": self.restitution}
        rows = {
            "x": [x], "y": [y], "vx": vx, "vy": vy, "mass": self.mass, "radius": self.radius, "body": -1,
            "pinned": int(self.pinned), **vars(world.surface),
            **{name: value for name, value in surface.items() if value is not None},
        }  # fmt: skip
        _join(world, {"particles": rows}, giver, ADD_PARTICLE)


@dataclass(frozen=True)
class AddSpring(Command):
    """Add a spring between two particles; rest_length [m], None = as placed; it is named +:0, +:1, ..."""

    type = "add_spring"
    particle_a: ParticleSlot
    particle_b: ParticleSlot
    rest_length: Length | None = None
    stiffness: Share = 0.5
    damping: Share = 0.9

    def carry_out(self, world: LevelWorld, giver: int) -> None:
        if self.particle_a == self.particle_b:
            name = world.particle_names[self.particle_a]
            raise CommandError(SAME_ENDS.format(name))
        rows = {
            "a": [-1 - self.particle_a], "b": [-1 - self.particle_b], "rest_length": self.rest_length,
            "stiffness": self.stiffness, "damping": self.damping,
        }  # fmt: skip
        _join(world, {"springs": rows, "materials": {"name": [world.material_names[0]]}}, giver, ADD_SPRING)


def _join(world: LevelWorld, columns: dict[str, dict[str, Any]], giver: int, kind: int) -> None:
    try:
        join_loose(world, columns, giver, kind)
    except KitError as error:
        raise CommandError(str(error)) from None


def name_added(world: World) -> None:
    """Name the slots that a restored state brought along as the commands that added them did."""
    for joined in world.joined:
        if joined.first_particle >= len(world.particle_names):
            world.name_slots_to(joined.first_particle, joined.first_spring)
            world.name_slots(joined.particle_names, joined.spring_names)
            for name, slot in joined.second_names:
                world.name_particle(slot, name)
    world.name_slots_to(world.particle_count, world.spring_count)
