"""Makes bodies soft as a whole, by a sag or a wobble, for any grid, size and mass: what a world itself needs of it."""
