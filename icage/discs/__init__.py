"""Disc fingers as point fingers round a grown object: offsets, brackets, true curves."""
