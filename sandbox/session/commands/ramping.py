"""Commands whose change takes time: the field `duration`.

What such a command sets goes there in so many ticks (sandbox/physics/ramps.py) from where it is, also from the middle
of what another one has begun; 0: at once. Recordings from before there were durations have none, and mean 0.
"""

from typing import Annotated

from pydantic import Field

from sandbox.level.format.quantities import unit
from sandbox.physics.marks import LONGEST_RAMP

Duration = Annotated[int, Field(ge=0, le=LONGEST_RAMP, json_schema_extra=unit("ticks"))]
