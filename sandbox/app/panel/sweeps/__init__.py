"""Sweeps as maps: in a picture, and behind the pad."""
