"""Splines of SciPy at the way-points of tests/robot_motion.rs: prints the numbers that the test quotes.

    python3 -m venv venv && venv/bin/pip install scipy==1.17.1
    venv/bin/python crates/bubbletouch-sim/tests/robots/splines.py
"""

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

TIMES = [0.0, 0.5, 1.7, 2.0, 4.0]
VALUES = [0.0, 1.0, 1.2, -0.7, 0.4]
AT = [0.25, 1.0, 1.9, 3.1]

clamped = CubicSpline(TIMES, VALUES, bc_type="clamped")
print("clamped", [float(clamped(t)) for t in AT], [float(clamped(t, 1)) for t in AT])
# Its ends are not still, so only pieces away from them are comparable.
monotone = PchipInterpolator(TIMES, VALUES)
print("monotone", [float(monotone(t)) for t in AT[1:3]], [float(monotone(t, 1)) for t in AT[1:3]])
