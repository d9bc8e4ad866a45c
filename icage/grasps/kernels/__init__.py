"""Compiled loops of the grasp search."""
