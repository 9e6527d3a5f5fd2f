"""Summary: the measurements of a headless run, for `sandbox run --json`."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np

from sandbox.physics.analysis.energy import (
    Dissipation,
    EnergyTests,
    energy_tests,
    forget_energy_tests,
    gravity_energy,
    kinetic_energy,
    spring_energy,
    steps_by_mass,
)
from sandbox.physics.analysis.query import load_bearing, shown_particles, shown_springs, strain
from sandbox.physics.settings import Substeps
from sandbox.physics.snapshot import state_hash
from sandbox.physics.world import World
from sandbox.session.outcome import outcome, outcome_text
from sandbox.session.session import Session

# Strain is measured over this last part of a run [s].
STRAIN_WINDOW = 2.0


@dataclass(frozen=True)
class Summary:
    """Figures of a run. Strain: |l - L| / L at every tick's end of the last 2 s; all else at the end of the run.

    Energies [J], gravity's zero at y = 0: potential is springs and gravity, dissipated is what Dissipation says;
    energy_tests: those of this run; steps_by_mass: of bodies on too many contacts to answer exactly (docs/physics.md,
    section 10); max_speed [m/s] of any particle; non_finite: particles without a finite position and velocity;
    outcome: of a level with a goal, "won at 12.40 s with 3 stars"; milliseconds_per_tick: median wall time of the step
    alone.
    """

    ticks: int
    simulated_seconds: float
    particles: int
    springs: int
    solver: str
    substeps: Substeps
    max_strain: float
    rms_strain: float
    kinetic_energy: float
    potential_energy: float
    spring_energy: float
    gravity_energy: float
    dissipated_energy: float
    energy_tests: EnergyTests
    steps_by_mass: int
    max_speed: float
    non_finite: int
    broken_springs: int
    hash: str
    outcome: str | None
    milliseconds_per_tick: float

    def text(self, name: str) -> str:
        """The figures of the level of that name, for a person."""
        return (
            f"{name}: {self.ticks} ticks ({self.simulated_seconds:g} s), {self.particles} particles, "
            f"{self.springs} springs, {self.solver}, {self.substeps} substeps\n"
            f"  strain        {self.max_strain:.3%} at most, {self.rms_strain:.3%} RMS (last 2 s)\n"
            f"  energy        {self.kinetic_energy:.6g} J kinetic, {self.spring_energy:.6g} J in springs, "
            f"{self.gravity_energy:.6g} J of gravity, {self.dissipated_energy:.6g} J dissipated\n"
            f"  energy test   {self.energy_tests}\n"
            f"  by mass       {self.steps_by_mass:,} steps of bodies on too many contacts\n"
            f"  fastest       {self.max_speed:.6g} m/s\n"
            f"  non-finite    {self.non_finite} particles, broken {self.broken_springs} springs\n"
            f"  a tick took   {self.milliseconds_per_tick:.4f} ms\n"
            + (f"  outcome       {self.outcome}\n" if self.outcome else "")
            + f"  hash          {self.hash}"
        )


def run(session: Session, ticks: int, on_tick: Callable[[World], None] | None = None) -> Summary:
    """Advance a session by a number of ticks and measure; on_tick: called with the world after every step."""
    world = session.world
    samples = max(1, round(STRAIN_WINDOW * world.settings.tick_rate))
    window: list[tuple[float, float, int]] = []
    times: list[float] = []
    dissipation = Dissipation()
    forget_energy_tests(world)
    with np.errstate(over="ignore", invalid="ignore"):
        for done in range(ticks):
            changed = session.apply_pending()
            dissipation.before(world, changed)
            start = time.perf_counter()
            session.advance()
            times.append(time.perf_counter() - start)
            dissipation.after(world)
            if ticks - done <= samples:
                window.append(strain_sample(world))
            if on_tick is not None:
                on_tick(world)
        session.apply_pending()
        ended, rate = outcome(session.level, world), session.level.settings.tick_rate
        said = None if ended is None else outcome_text(ended, rate)
        return _summary(world, ticks, window, times, dissipation.energy, said)


def strain_sample(world: World) -> tuple[float, float, int]:
    """Largest |strain|, sum of squares and count of the springs that bear load."""
    size = np.abs(strain(world)[load_bearing(world)])
    return (float(size.max()), float(np.sum(size * size)), len(size)) if len(size) else (0.0, 0.0, 0)


def _summary(
    world: World,
    ticks: int,
    window: list[tuple[float, float, int]],
    times: list[float],
    dissipated: float,
    outcome: str | None,
) -> Summary:
    shown = shown_particles(world)
    speed = np.sqrt(np.sum(world.velocity[shown] ** 2, axis=1))
    finite = np.isfinite(speed) & np.isfinite(world.position[shown]).all(axis=1)
    samples = sum(count for _, _, count in window)
    active = int(np.count_nonzero(shown_springs(world)))
    real = sum(not world.is_grab_spring(slot) for slot in range(world.spring_count))
    springs_hold, gravity_holds = spring_energy(world), gravity_energy(world)
    return Summary(
        ticks=ticks,
        simulated_seconds=ticks / world.settings.tick_rate,
        particles=int(np.count_nonzero(shown)),
        springs=active,
        solver=world.settings.solver,
        substeps=world.settings.substeps,
        max_strain=float(np.max([largest for largest, _, _ in window], initial=0.0)),
        rms_strain=float(np.sqrt(sum(squares for _, squares, _ in window) / samples)) if samples else 0.0,
        kinetic_energy=kinetic_energy(world),
        potential_energy=springs_hold + gravity_holds,
        spring_energy=springs_hold,
        gravity_energy=gravity_holds,
        dissipated_energy=dissipated,
        energy_tests=energy_tests(world),
        steps_by_mass=steps_by_mass(world),
        max_speed=float(speed.max()) if len(speed) else 0.0,
        non_finite=int(np.count_nonzero(~finite)),
        broken_springs=real - active,
        hash=state_hash(world),
        outcome=outcome,
        milliseconds_per_tick=1e3 * median(times) if times else 0.0,
    )


def particle_metric(world: World, particle: str, metric: str) -> float:
    """x, y [m] or speed [m/s] of a particle by name. Raises KeyError."""
    slot = world.particle_slot(particle)
    x, y = world.position[slot].tolist()
    return {"x": x, "y": y, "speed": float(np.hypot(*world.velocity[slot]))}[metric]
