"""``icage escape``: the plan's sigma_max attacked in physics, and measured."""
