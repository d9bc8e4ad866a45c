"""A second opinion: closings and random attacks in another physics engine (Chipmunk2D, by pymunk)."""
