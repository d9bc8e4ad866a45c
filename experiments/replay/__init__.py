"""``icage replay``: plan, draw placements, close from each, keep what happened, film it."""
