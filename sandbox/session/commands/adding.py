"""Particles and springs are added to a running world, and named."""

from dataclasses import asdict, dataclass

from sandbox.level.format.limits import PARTICLE_LIMIT, SPRING_LIMIT
from sandbox.level.format.quantities import Length, Mass, Point, Share
from sandbox.physics.world import LAW_NISSEN, World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot, particle_of


@dataclass(frozen=True)
class AddParticle(Command):
    """Add a particle at position [m], of mass [kg] and radius [m]; it is named +.0, +.1, ... in order of adding."""

    type = "add_particle"
    position: Point
    mass: Mass = 1.0
    radius: Length = 0.05
    pinned: bool = False

    def carry_out(self, world: World) -> None:
        if world.particle_count >= PARTICLE_LIMIT:
            raise CommandError(f"a world holds at most {PARTICLE_LIMIT:,} particles")
        world.add_particles(
            _next_names("+.", world.particle_names),
            [self.position],
            mass=self.mass,
            radius=self.radius,
            pinned=self.pinned,
            **asdict(world.surface),
        )


@dataclass(frozen=True)
class AddSpring(Command):
    """Add a spring between two particles; rest_length [m], None = as placed; it is named +:0, +:1, ..."""

    type = "add_spring"
    particle_a: ParticleSlot
    particle_b: ParticleSlot
    rest_length: Length | None = None
    stiffness: Share = 0.5
    damping: Share = 0.9

    def carry_out(self, world: World) -> None:
        if world.spring_count >= SPRING_LIMIT:
            raise CommandError(f"a world holds at most {SPRING_LIMIT:,} springs")
        name = particle_of(world, self.particle_a)
        particle_of(world, self.particle_b)
        if self.particle_a == self.particle_b:
            raise CommandError(f"a spring joins two different particles, not {name} to itself")
        world.add_springs(
            _next_names("+:", world.spring_names),
            [self.particle_a],
            [self.particle_b],
            rest_length=self.rest_length,
            stiffness=self.stiffness,
            damping=self.damping,
            law=LAW_NISSEN,
        )


def _next_names(prefix: str, names: list[str], count: int = 1) -> list[str]:
    first = sum(name.startswith(prefix) for name in names)
    return [f"{prefix}{number}" for number in range(first, first + count)]


def name_added(world: World) -> None:
    """Name the slots that a restored state brought along as the commands that added them did."""
    if len(world.particle_names) <= world.grab_particle:
        # A level without particles reserves its hands at the first grab, behind what was added until then.
        _name_slots(world, world.grab_particle, world.grab_spring)
        world.name_grabs()
    _name_slots(world, world.particle_count, world.spring_count)


def _name_slots(world: World, particle_count: int, spring_count: int) -> None:
    """Name the slots up to these counts that have no name yet."""
    world.name_slots(
        _next_names("+.", world.particle_names, particle_count - len(world.particle_names)),
        _next_names("+:", world.spring_names, spring_count - len(world.spring_names)),
    )
