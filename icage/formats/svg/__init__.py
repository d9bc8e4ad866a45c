"""Drawings from SVG as a browser sees them: tree, cascade, structure, shapes, clips, paint."""
