"""Every error a caller can act on: what was asked, what was found, what is allowed."""

from __future__ import annotations


class IcageError(Exception):
    """Base of all errors that icage raises on purpose."""


class InputError(IcageError):
    """Something a user gave is wrong; the command line answers with exit code 2."""


class OutlineError(InputError):
    """The outline is not one simple polygon with an area."""


class HandError(InputError):
    """The three fingers do not form a counterclockwise triangle."""


class GraspError(InputError):
    """The contacts cannot be a grasp of this outline with this finger radius."""


class CaseError(InputError):
    """A case file is not what the case format allows."""


class PlacementError(InputError):
    """A placement (x, y, theta, sigma) is not usable."""


class FormatError(InputError):
    """A drawing cannot be read."""


class LibraryError(InputError):
    """A library that computes geometry gave up on what a user gave: too fine, or too near a tie."""


class MethodError(InputError):
    """The method that planned a cage cannot answer; the error names the one that can."""


class OutputError(InputError):
    """The place a user named for an answer cannot take it."""


class GeometryError(IcageError):
    """A computation broke one of its own invariants: our fault, never the user's."""
