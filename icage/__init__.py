"""icage: how far may a three-finger hand open before the object inside it can escape?

Import from the modules (``from icage.outline import Outline``): the package root stays empty so
that a command that only prints its help loads neither shapely nor numba.
"""

__version__ = "0.1.0"
