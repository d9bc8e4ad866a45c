"""From what a reader found in a file to one outline: areas, parts, size, simplification."""
