"""Draw the golden pictures anew: needs kernels."""

import pygame

from sandbox.physics.jit import COMPILED
from tests.app.golden_pictures import PICTURES, drawn, golden

if not COMPILED:
    raise SystemExit("golden pictures are drawn by kernels, which are interpreted here")
for name, theme, lattice in PICTURES:
    pygame.image.save(drawn(name, theme, lattice), str(golden(name)))
    print(f"{golden(name).name}: {golden(name).stat().st_size / 1000:.0f} kB")
