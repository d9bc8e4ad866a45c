"""The exact method: the free space cut into convex cells, and the passes between them."""
