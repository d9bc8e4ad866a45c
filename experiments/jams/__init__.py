"""Physics as the judge of what friction leaves of the guarantee (``Cage.friction``).

``closings`` closes hands from below and from above a level, ``beside`` attacks the jams that
limit it and measures at which friction they begin to hold, ``settings`` repeats that with other
settings of the engine, ``run`` does all of it for a case, ``document`` writes it down.
``python -m experiments.jams`` is the command.
"""
