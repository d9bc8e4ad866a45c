"""What every field of a study means: the help of the command line and of the config, once."""

from __future__ import annotations

from typing import Final

from icage.formats.drawings.reading import ReadingOptions

HELP: Final = {
    "case": "a case file, a shipped object's name, a drawing or an outline without a "
    "grasp, for which the best grasp is searched, or a study's TOML file",
    "grasp": "which of a list of grasps or of a shipped object's grasps, from 1 (default 1)",
    "trials": "how many (default 1000); saltelli rounds its base points up to a power of two",
    "seed": "seed of everything that is drawn (default 0)",
    "starts": "where the hand is meant to stand: guaranteed (uniform in the guaranteed set), cage "
    "(uniform in the whole cage) or nominal (one placement); default: nominal if placement varies, "
    "else guaranteed",
    "nominal": "x,y,theta,sigma of the nominal placement, in the case's unit and rad (where x is "
    "negative: --nominal=...); default: the one with the most room of 1,000 from the guaranteed "
    "set",
    "place": "best: the nominal placement is the one whose fingers and opening may be off by most "
    "(icage place --opening-error)",
    "sampling": "random (default), sobol (scrambled: rates converge faster) or saltelli (says "
    "which input matters most)",
    "uncaged": "starts that the planner does not call caged: close from them all the same (the "
    "default), or skip them; counted either way",
    "until_half_width": "stop when the 95 %% interval of the target rate is this narrow: half of "
    "it at most this; looked at every 500 trials; for random sampling only",
    "position_tolerance": "an end counts as in a grasp within this, in diameters (default 0.005)",
    "angle_tolerance": "... and turned by no more than this, in rad (default 0.02)",
    "max_time": "in s, a closing still moving then has timed out (default 5; a slower hand has as "
    "much longer)",
    "time_step": "time step of the engine, in s (default 0.001)",
    "vary": "an uncertain input, e.g. friction=0:0.8 or place_xy=normal:2mm; `--variables` lists "
    "them; as often as there are inputs",
}

DRAWING: Final = (*ReadingOptions.__annotations__, "finger_radius")
"""What goes with a drawing in place of a case: options of the command, and no fields of a study."""
