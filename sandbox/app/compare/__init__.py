"""Two runs side by side that the same hands work on."""
