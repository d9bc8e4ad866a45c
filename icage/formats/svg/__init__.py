"""Outlines from SVG drawings: the tree, its shapes, their curves, what they fill."""
