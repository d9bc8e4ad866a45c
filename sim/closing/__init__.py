"""The hand closes on the free object: one trial or many, and where each ended."""
