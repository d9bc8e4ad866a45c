"""Which case is meant: a name, a file, a drawing; by one method or both; with discs for physics."""
