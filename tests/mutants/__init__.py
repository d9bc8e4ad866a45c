"""Mutants of the planner: one change in one function, and whether a test sees it."""
