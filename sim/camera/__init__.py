"""Frames from the offscreen renderer."""
