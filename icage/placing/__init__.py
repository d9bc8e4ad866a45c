"""Where to put the open hand so that it may be off by most."""
