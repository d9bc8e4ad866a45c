"""Monte Carlo studies: how wrong may placement, friction, shape and hand be?"""
