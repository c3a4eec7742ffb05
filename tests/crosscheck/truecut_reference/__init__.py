"""Second opinion on truecut: MuJoCo plant, process laws written from `docs/physics`.

Nothing here reads truecut's own code. What comes in is the scenario file, the exported MJCF
and, for the comparison, the recorded channels.
"""
