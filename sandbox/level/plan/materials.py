"""Materials as arrays: law and coefficients of every spring, and the strains at which it breaks or yields."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import HookeMaterial, Material
from sandbox.physics.breaking import NEVER, StrainLimits
from sandbox.physics.marks import LAW_HOOKE, LAW_NISSEN


def coefficients(material: NDArray[np.int64], materials: dict[str, Material]) -> dict[str, NDArray[np.generic]]:
    """Law and coefficients of every spring (m,), as arguments of World.add_springs."""
    rows = [_row(chosen) for chosen in materials.values()]
    law, stiffness, damping, k, c = (np.array(column)[material] for column in zip(*rows, strict=True))
    return {"law": law, "stiffness": stiffness, "damping": damping, "hooke_stiffness": k, "hooke_damping": c}


def strain_limits(materials: dict[str, Material]) -> StrainLimits:
    """The strains at which springs of each material break and yield."""

    def column(name: str) -> NDArray[np.float64]:
        values = [getattr(material, name) for material in materials.values()]
        return np.array([NEVER if value is None else value for value in values], dtype=np.float64)

    yielding = column("yield_strain")
    return StrainLimits(
        tension=column("tension_limit"),
        compression=column("compression_limit"),
        yielding=yielding,
        yield_share=np.where(np.isfinite(yielding), column("yield_limit"), 0.0),
    )


def _row(material: Material) -> tuple[int, float, float, float, float]:
    if isinstance(material, HookeMaterial):
        return LAW_HOOKE, 0.0, 0.0, material.k + 0.0, material.c + 0.0
    return LAW_NISSEN, material.stiffness + 0.0, material.damping + 0.0, 0.0, 0.0
