"""MuJoCo side of icage: the hand, the free object, and what happens when the hand closes.

Import from the modules. Nothing here plots, and nothing touches ``MUJOCO_GL`` at import.
"""
