"""What a study varies: its inputs, their distributions, its description, its design."""
