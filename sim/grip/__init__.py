"""The closed hand: contact forces, form closure, play, shaking, friction."""
