"""The page to play with: one HTML file that answers as ``icage query`` does, without a server."""
