"""Whole inputs of every format, small, from which mutations begin."""
