"""Finding target grasps: the best ones of an outline, or all of one hand."""
