"""Plane geometry that every method needs: convex pieces, statics, contact types, least opening."""
