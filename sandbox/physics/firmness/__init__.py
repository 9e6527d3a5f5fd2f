"""Firmness: how soft a body is as a whole, by its sag or its wobble, for any grid, size and mass."""
