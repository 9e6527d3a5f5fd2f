"""The input of a substep, as one argument for kernels."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from sandbox.physics.jit import bundle
from sandbox.physics.substeps import Substep
from sandbox.physics.world import Floats


class SubstepArrays(NamedTuple):
    """The arrays that stay the same objects in every substep of a tick, often of many ticks.

    Cs and Cd of springs (m,) and constraints (t,) in a substep; start [m/s] (n, 2): velocities before forces.
    """

    stiffness: Floats
    damping: Floats
    constraint_stiffness: Floats
    constraint_damping: Floats
    start: Floats


@dataclass(eq=False)
class LentSubstep:
    """The arrays of a world's last substep, and the same as one argument for kernels."""

    arrays: SubstepArrays | None = None
    inputs: Any = None

    def lend(self, substep: Substep) -> Any:
        """The arrays of a substep, lent again if they are not those of the last one."""
        (stiffness, damping), (more_stiffness, more_damping) = substep.springs, substep.constraints
        arrays = self.arrays
        if (
            arrays is None
            or arrays.stiffness is not stiffness
            or arrays.damping is not damping
            or arrays.constraint_stiffness is not more_stiffness
            or arrays.constraint_damping is not more_damping
            or arrays.start is not substep.step_start.velocity
        ):
            self.arrays = SubstepArrays(stiffness, damping, more_stiffness, more_damping, substep.step_start.velocity)
            self.inputs = bundle((self.arrays,))
        return self.inputs
