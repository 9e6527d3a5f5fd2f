"""The torques of motors, for panels, probes and summaries; no tick depends on them."""

from typing import NamedTuple

from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World

# A motor that uses this share of its torque is at its limit.
AT_LIMIT = 0.999


class MotorReading(NamedTuple):
    """A motor's name, the torque that it gave in the last step [N m], the most that it has, and whether it can act.

    pushes: its wheel is on its hub, and there is something to push against.
    """

    name: str
    torque: float
    limit: float
    pushes: bool

    @property
    def share(self) -> float:
        """The share of its torque that is in use, 0..1."""
        return abs(self.torque) / self.limit if self.limit > 0.0 else 0.0

    @property
    def at_limit(self) -> bool:
        """Whether it gives all that it has: more load, and it falls behind its speed or stalls."""
        return self.share >= AT_LIMIT


def motor_readings(world: World) -> list[MotorReading]:
    """The reading of every motor, in the order of a world's motors."""
    motors, joints = world.actuators.motors, block_of(world).arrays.joints
    # What is kept is that of a substep, with "auto" as if the tick were one.
    h = substep_time(world.settings)
    first = joints.rows.first
    return [
        MotorReading(
            world.actuators.names[part],
            float(world.actuator_impulse[part]) / h,
            float(motors.torque[k]),
            bool(first[k] < first[k + 1]),
        )
        for k, part in enumerate(motors.part.tolist())
    ]
