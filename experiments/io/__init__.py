"""What all commands share at their edges: options, progress, versions, words, intervals."""
