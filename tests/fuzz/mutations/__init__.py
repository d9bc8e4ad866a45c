"""Ways to spoil an input: of bytes, of text, and of what a format is made of."""
