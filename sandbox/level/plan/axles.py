"""Axles: the mounts of wheels, and which wheels pass through theirs."""

from collections import defaultdict

from sandbox.level.document.model import Level
from sandbox.level.kinds.wheel import WheelDef


def free_wheels(level: Level) -> list[tuple[int, frozenset[int]]]:
    """Wheels that pass through their mounts, with their mounts, by index."""
    wheels = (index for index, body in enumerate(level.bodies) if isinstance(body, WheelDef) and not body.touches_mount)
    found = [(wheel, mount_of(level, wheel)) for wheel in wheels]
    return [(wheel, mount) for wheel, mount in found if mount]


def mount_of(level: Level, wheel: int) -> frozenset[int]:
    """The mount of a wheel, by index: bodies, then loose particles.

    It is everything that welds and loose springs join to the hub, directly or through others, without the wheel.
    """
    axle = level.bodies[wheel].id
    ids = [*(body.id for body in level.bodies), *(particle.id for particle in level.particles)]
    number = {name: index for index, name in enumerate(ids)}
    beside: dict[int, set[int]] = defaultdict(set)
    for first, second in (*level.welds, *((spring.a, spring.b) for spring in level.springs)):
        ends = [reference.partition(".")[::2] for reference in (first, second)]
        # A rim that is tied to something is not mounted on it.
        if all(part in ("hub", "0") for owner, part in ends if owner == axle):
            a, b = (number[owner] for owner, _ in ends)
            beside[a].add(b)
            beside[b].add(a)
    mount, waiting = {wheel}, [wheel]
    while waiting:
        new = beside[waiting.pop()] - mount
        mount |= new
        waiting += new
    return frozenset(mount - {wheel})
