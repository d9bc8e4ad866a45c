"""What a study found: summary, page, maps and figures."""
