"""Compiled kernels: plain functions on arrays, no objects, no Python in the loop."""
