"""The commands: what a user runs. Nothing is imported here, so that ``--help`` stays quick."""
