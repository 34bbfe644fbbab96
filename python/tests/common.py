"""Where the program and the repository are, and a system that several tests ask."""

import os
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILT = [os.path.join(ROOT, "target", kind, "palmistry") for kind in ("release", "quick", "debug")]
PROGRAM = os.environ.get("PALMISTRY", next((path for path in BUILT if os.path.exists(path)), BUILT[0]))

built = unittest.skipUnless(os.path.exists(PROGRAM), "the program is not built: cargo build --release, or name it in PALMISTRY")

#: Its third claim is refuted.
PENDULUM = """system "A pendulum whose angle is measured"
state phi, omega
param k = 2
angle phi
drift f
  phi'   = omega
  omega' = -k*sin(phi)
output phi
sample
  phi   in [-3, 3]
  omega in [-2, 2]
claim motion: L(f, f, phi) = -k*sin(phi)
claim observable: rank = 2
claim sign: L(f, omega) = k*sin(phi)
"""
