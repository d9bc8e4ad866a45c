"""What users bring: drawings, case files, placements. One file per format."""
