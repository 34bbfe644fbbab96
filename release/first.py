"""A first verdict by the Python package, away from its sources."""

import palmistry

system = palmistry.System.parse("""system "A falling body"
state h, v
param g
drift f
  h' = v
  v' = -g
output h
claim motion: L(f, f, h) = -g
claim rank: rank = 2
""")
verdicts = [claim.verdict for claim in system.prove()]
assert verdicts == ["proved", "proved"], verdicts
print("library: first verdicts as expected")
