"""The live page: contacts chosen on the outline, planned again, closed in physics; on loopback."""
