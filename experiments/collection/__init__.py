"""The best grasps of a folder of objects: one search each, kept as they come, one table at last."""
