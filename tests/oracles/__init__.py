"""Independent checkers of the planner: nothing in here imports icage."""
