"""A second opinion: closings and attacks in another physics engine (Chipmunk2D, by pymunk)."""
