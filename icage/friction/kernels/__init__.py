"""The inner loops of the jam set, in machine code."""
