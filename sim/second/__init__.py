"""A second opinion: closings and random attacks in another physics engine (Chipmunk2D, by pymunk).

Optional: ``pip install icage[second]``. Nothing outside this package imports it, so that no result
of MuJoCo depends on it; see docs/decisions/0006-second-engine.md.
"""
