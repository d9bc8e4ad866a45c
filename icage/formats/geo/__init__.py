"""Outlines from geometry as text: GeoJSON and WKT."""
