"""Independent checkers of the planner: of icage they take the outline and the hand, no algorithm.

What compares the program with itself is in ``against_itself``.
"""
