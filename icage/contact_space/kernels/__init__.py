"""Compiled loops of the contact space. Nothing here is shared with the cells' kernels."""
