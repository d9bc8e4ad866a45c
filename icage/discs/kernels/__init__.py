"""Kernels of the true curve of disc fingers: features, forces on them, Newton's method."""
