# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A derivation that is checked by CI
#
# A cart with a pendulum, as in many a paper: the equations of motion, the energy, a linearisation. One sign is wrong. A job that runs `palmistry
# prove` at each commit finds it, names a state at which it fails, and stays green once it is mended.

# %%
import subprocess
import tempfile
import xml.etree.ElementTree
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from palmistry import System
from workbench import PROGRAM

CART = """
system "A cart with a pendulum"
state x, v, phi, omega             # phi from hanging down
param m, M, l, g
param F                            # the force on the cart
angle phi
let D = M + m*sin(phi)^2

drift f
  x'     = v
  v'     = (F + m*sin(phi)*(l*omega^2 + g*cos(phi)))/D
  phi'   = omega
  omega' = (-F*cos(phi) - m*l*omega^2*sin(phi)*cos(phi) - (M + m)*g*sin(phi))/(l*D)

output x

let bob = [x + l*sin(phi); -l*cos(phi)]
let energy = M*v^2/2 + m*dot(L(f, bob), L(f, bob))/2 - m*g*l*cos(phi)

claim newton:  (M + m)*L(f, v) + m*l*(L(f, omega)*cos(phi) - omega^2*sin(phi)) = F
claim swing:   l*L(f, omega) + L(f, v)*cos(phi) + g*sin(phi) = 0
claim power:   L(f, energy) = F*v
claim hanging: L(f, omega) at {phi = 0} = -F/(l*M)
claim jerk:    L(f, f, phi) = (-F*cos(phi) + m*l*omega^2*sin(phi)*cos(phi) - (M + m)*g*sin(phi))/(l*D)
claim full:    rank = 4
"""

system = System.parse(CART)
claims = system.prove()
angles = np.linspace(-1.5, 1.5, 41)
at = {"m": 1, "M": 2, "l": 1, "g": 10, "omega": 1, "F": 0, "x": 0, "v": 0}
printed, derived = ([float(system.eval(side, at=at | {"phi": angle})) for angle in angles] for side in claims["jerk"].statement.split(" = ")[::-1])
plt.plot(angles, printed, label="as printed")
plt.plot(angles, derived, label="as the equations of motion have it")
plt.xlabel("phi, rad")
plt.title("The second derivative of the angle")
plt.legend()
plt.show()
{claim.id: claim.verdict for claim in claims}

# %% [markdown]
# *Proved* is an exact argument, for all states and parameters for which both sides exist. What is *refuted* comes with a state in exact numbers, and the values of both
# sides there:

# %%
assert [claim.verdict for claim in claims] == ["proved"] * 4 + ["refuted", "proved"]
[wrong] = [claim for claim in claims if claim.verdict == "refuted"]
print(wrong.id, "is", wrong.verdict)
print("left ", wrong.witness["left"])
print("right", wrong.witness["right"])

# %% [markdown]
# The second term under the bracket has lost its minus. Mended, it is proved.

# %%
MENDED = CART.replace("-F*cos(phi) + m*l*omega^2", "-F*cos(phi) - m*l*omega^2")
assert all(claim.verdict == "proved" for claim in System.parse(MENDED).prove())

# %% [markdown]
# ## In CI
#
# The exit status is 0 when all is as expected and 1 when something is not. `--junit` writes the form that CI services show. In a workflow:
#
# ```yaml
# - run: cargo install palmistry
# - run: palmistry prove derivations/ --junit claims.xml
# ```

# %%
with tempfile.TemporaryDirectory() as folder:
    for name, text, expected in (("as_printed", CART, 1), ("mended", MENDED, 0)):
        proof, report = Path(folder, f"{name}.proof"), Path(folder, f"{name}.xml")
        proof.write_text(text)
        done = subprocess.run([PROGRAM, "prove", str(proof), "--junit", str(report)], capture_output=True, check=False)
        cases = list(xml.etree.ElementTree.parse(report).getroot().iter("testcase"))
        failed = [case.get("name") for case in cases if case.find("failure") is not None]
        assert (done.returncode, len(cases), len(failed)) == (expected, 6, expected)
        print(f"{name}: exit status {done.returncode}, {len(cases)} cases, failed: {failed}")

# %% [markdown]
# A mistake in print that is known is no failure: the file says `erratum`, gives the form in print and the right one, and the check holds both, the first to be refuted and
# the second to be proved.

# %%
KNOWN = MENDED.replace("claim jerk:    L(f, f, phi) =", "erratum jerk:\n  printed L(f, f, phi) = (-F*cos(phi) + m*l*omega^2*sin(phi)*cos(phi) - (M + m)*g*sin(phi))/(l*D)\n"
                                                        "  corrected L(f, f, phi) =")
known = System.parse(KNOWN).prove()["jerk"]
assert known.ok and known.json["printed"]["verdict"] == "refuted" and known.json["corrected"]["verdict"] == "proved"
known.verdict, known.json["printed"]["verdict"], known.json["corrected"]["verdict"]
