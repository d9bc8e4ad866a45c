"""``icage video``: a short film of one thing that a lecture has to show."""
