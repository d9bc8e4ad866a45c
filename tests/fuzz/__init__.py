"""Mutated inputs of every kind that icage reads: a budget, a seed, and what must hold of each."""
