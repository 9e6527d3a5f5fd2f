"""Situations: a level given by its parts, as files have them, and a run of it."""

import json
from typing import Any

import numpy as np

from sandbox.level.reading.parse import parse_level
from sandbox.physics.arrays import Floats, Slots
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session

RIGID = {"stiffness": 1.0, "damping": 1.0}


def session_of(**parts: Any) -> Session:
    """A run of a level of these parts; its material is "m", rigid where none is given."""
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "situation", "materials": {"m": RIGID}, **parts
    }  # fmt: skip
    return Session(parse_level(json.dumps(level).encode(), "situation"))


def slots_of(session: Session, body: str) -> Slots:
    """The particles (k,) of a body."""
    names = session.world.particle_names
    return np.array([k for k, name in enumerate(names) if name.startswith(f"{body}.")], dtype=np.int64)


def advance(session: Session, ticks: int) -> Session:
    """Run it for so many ticks."""
    for _ in range(ticks):
        session.advance()
    return session


def order(session: Session, **record: Any) -> None:
    """Submit a command by its record."""
    session.submit(from_record(record, session.world))


def angular_momentum(session: Session, particles: Slots, about: Floats | None = None) -> float:
    """Angular momentum [kg m^2/s] of particles about their centre of mass, or about a place [m]."""
    world = session.world
    mass, place, velocity = world.mass[particles], world.position[particles], world.velocity[particles]
    centre = np.average(place, axis=0, weights=mass) if about is None else about
    drift = np.average(velocity, axis=0, weights=mass) if about is None else np.zeros(2)
    r, v = place - centre, velocity - drift
    return float(np.sum(mass * (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0])))
