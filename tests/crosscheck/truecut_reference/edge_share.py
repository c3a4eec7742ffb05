"""What part of the line reaction in planes an edge under a point patch bears (tests/reference/edge_share.py)."""

import numpy as np
from scipy.interpolate import RegularGridInterpolator

# sqrt(N/2Rq) / (1 + sqrt(N/2Rq)); the edge's place in half lengths of the overlap, positive with the middle on the face.
STRETCHES = (0.0, 0.075615, 0.166662, 0.285590, 0.414380, 0.533308, 0.624385, 0.72)
PLACES = (-0.951362, -0.806526, -0.538903, -0.189238, 0.189238, 0.538903, 0.806526)
SHARES = (
    (1.0,) * 7,
    (0.9812, 0.9878, 0.9905, 0.9925, 0.9928, 0.9918, 0.9873),
    (0.9379, 0.9633, 0.9707, 0.9747, 0.9783, 0.9832, 0.9880),
    (0.8853, 0.9181, 0.9306, 0.9372, 0.9472, 0.9527, 0.9527),
    (0.8284, 0.8594, 0.8744, 0.8811, 0.8953, 0.9063, 0.9063),
    (0.8029, 0.8076, 0.8226, 0.8240, 0.8394, 0.8526, 0.8526),
    (0.7624, 0.7690, 0.7762, 0.7778, 0.7941, 0.7941, 0.7941),
    (0.7240, 0.7197, 0.7227, 0.7227, 0.7385, 0.7385, 0.7385),
)
_TABLE = RegularGridInterpolator((STRETCHES, PLACES), np.array(SHARES))


def edge_share(layer: float, place: float) -> float:
    """At N/2Rq and a place; beyond the table its border."""
    root = np.sqrt(layer)
    at = np.clip(root / (1.0 + root), 0.0, STRETCHES[-1]), np.clip(place, PLACES[0], PLACES[-1])
    return float(_TABLE(at).item())
