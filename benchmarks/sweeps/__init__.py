"""Large seeded sweeps that compare the planner with itself where it must not differ."""
