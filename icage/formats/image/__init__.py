"""Outlines from PNG and JPEG images: decoding, what is the object, a contour between pixels."""
