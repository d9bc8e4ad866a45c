"""Compiled loops of the search for the best placement."""
