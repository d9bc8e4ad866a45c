"""What the site adds to Sphinx, none of which is needed to read the pages on a forge."""
