"""How soft is this body: by its firmness, its sag, its slowest wobble and when it buckles; in numbers and in words.

firmness.py: which bodies have a firmness, what of it is in reach, and setting it. body_motion.py: what theory says of
Cs and Cd in each solver. settling.py: a run of a body alone, as it is held. sag_meter.py: sags that such runs tell.
"""
