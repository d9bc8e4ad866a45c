"""Outlines from DXF drawings: tags, entities, blocks, layers."""
