"""Outlines from triangle meshes: STL, OBJ, PLY; a section, or the silhouette along an axis."""
