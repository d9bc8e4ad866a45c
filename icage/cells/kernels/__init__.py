"""Compiled loops of the cells' method: plain functions on arrays."""
