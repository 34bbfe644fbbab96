"""Where the program and the repository are."""

import os
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILT = [os.path.join(ROOT, "target", kind, "palmistry") for kind in ("release", "quick", "debug")]
PROGRAM = os.environ.get("PALMISTRY", next((path for path in BUILT if os.path.exists(path)), BUILT[0]))

built = unittest.skipUnless(os.path.exists(PROGRAM), "the program is not built: cargo build --release, or name it in PALMISTRY")
