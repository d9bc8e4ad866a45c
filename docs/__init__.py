"""The documents, and the command that makes a site of them: ``python3 -m docs``."""
