"""``icage grasps OUTLINE-OR-CASE``: the best target grasps of an object, or all of one hand."""
