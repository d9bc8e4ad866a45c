"""Data of the shipped objects and of the hand, and the one loader that finds it."""
