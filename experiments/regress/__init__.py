"""``icage regress``: the planner against itself and against physics, case by case, with a baseline.

``cases`` says what is run, ``measure`` runs one case, ``closings`` closes hands for it, ``checks``
says what must hold whatever the baseline, ``baseline`` compares with what was committed, ``table``
and ``junit`` write it down, ``run`` does all of it on all cores.
"""
