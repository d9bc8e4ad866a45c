"""Pictures of plans: the plan figure, the figures of the paper, and what all drawings share."""
