"""Hand and object as one compiled model, in normalized units."""
