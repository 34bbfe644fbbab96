"""Is a circular palm better than a flat one? The bound of both radii over the curvatures of both palms: the map in the book's page on scenes.

    python3 benches/circular_map.py [--program target/release/palmistry] [--points 7] [--picture FILE]

The shipped scene of circular palms, one window of 81 samples over 0.28 s, contacts read to 0.1 mm, at nine motions: three orientations and three rates of the
body at the start. At each motion and pair of curvatures the larger bound (Cramer and Rao, at the truth) of r1 and r2 is taken over that between
flat palms in the same motion; the map is the median over the motions that both palms hold to the end, flat ones and these.
"""

import argparse
import json
import math
import re
import statistics
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SCENE = ROOT / "proofs/moll2002/scenes/circular_palms.toml"
LARGEST = 0.25  # 1/m
MOTIONS = [(orientation, rate) for orientation in (3.4, 4.2, 5.6) for rate in (-0.8, 0.5, 1.5)]


def scene(curvatures, motion):
    text = SCENE.read_text().replace('"../', f'"{SCENE.parent.parent}/').split("[study.")[0]
    radii = ["inf" if curvature == 0 else repr(1 / curvature) for curvature in curvatures]
    for key, value in [
        ("radii", f"[{radii[0]}, {radii[1]}]"), ("orientation", repr(motion[0])), ("rate", repr(motion[1])),
        ("duration", "0.28"), ("samples", "81"), ("methods", '["trust-region"]'), ("guess", '"none"'), ("window", "80"),
    ]:
        text = re.sub(rf"^{key} = .*", f"{key} = {value}", text, count=1, flags=re.M)
    text = re.sub(r'^guess = "none"\n', "", text, flags=re.M)
    return text.replace("[observer]\n", "[sensor]\nnoise = 1e-4\n[observer]\nguess_off = 0.0\n")


def bound(program, folder, curvatures, motion):
    """The larger bound in m: infinite where blind or lost, none where the body is not held."""
    path = folder / "scene.toml"
    path.write_text(scene(curvatures, motion))
    done = subprocess.run([program, "observe", str(path), "--json"], capture_output=True, text=True, cwd=ROOT)
    answer = json.loads(done.stdout)
    if "observers" not in answer or answer["samples"] < 81:
        return None
    updates = answer["observers"][0]["updates"]
    found = [updates[0]["states"][name]["bound"] for name in ("r1", "r2")] if updates else [None]
    return math.inf if None in found else max(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/release/palmistry"))
    parser.add_argument("--points", type=int, default=7)
    parser.add_argument("--picture")
    options = parser.parse_args()
    side = [LARGEST * (2 * i / (options.points - 1) - 1) for i in range(options.points)]
    side = [0.0 if abs(curvature) < 1e-12 else curvature for curvature in side]
    rows, better, best = [], 0, []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        flat = [bound(options.program, folder, (0.0, 0.0), motion) for motion in MOTIONS]
        for second in side:
            row = []
            for first in side:
                ratios = []
                for motion, reference in zip(MOTIONS, flat):
                    here = bound(options.program, folder, (first, second), motion) if reference else None
                    if here is not None and math.isfinite(reference):
                        ratios.append(here / reference)
                row.append((statistics.median(ratios) if ratios else math.nan, min(ratios, default=math.nan), max(ratios, default=math.nan), len(ratios)))
            rows.append(row)
            print(f"{second:+.3f} | " + " | ".join(f"{m:.2f} ({a:.2f} to {b:.3g}, {n})" for m, a, b, n in row), flush=True)
    print("flat, in mm: " + ", ".join("none" if f is None else f"{1e3 * f:.3g}" for f in flat))
    print("columns, the curvature of palm 1 in 1/m: " + ", ".join(f"{curvature:+.3f}" for curvature in side))
    if options.picture:
        Path(options.picture).write_text(picture(side, rows))


def picture(side, rows):
    """An SVG: blue where the bound is smaller than between flat palms, ochre where it is larger."""
    n, cell = len(side), 44
    size = 90 + n * cell
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size + 10}" font-family="sans-serif" font-size="12">']
    parts.append(f'<rect width="{size}" height="{size + 10}" fill="white"/><title>The bound over that of flat palms</title>')
    for j, row in enumerate(rows):
        for i, (middle, *_) in enumerate(row):
            strength = max(-1.0, min(1.0, math.log(middle, 4))) if middle > 0 and math.isfinite(middle) else 1.0
            ends = (86, 156, 214) if strength < 0 else (213, 150, 60)
            colour = ",".join(str(round(255 + (end - 255) * abs(strength))) for end in ends)
            x, y = 70 + i * cell, 10 + (n - 1 - j) * cell
            parts.append(f'<rect x="{x}" y="{y}" width="{cell}" height="{cell}" fill="rgb({colour})" stroke="#888"/>')
            text = f"{middle:.2f}" if math.isfinite(middle) else "blind" if middle > 0 else "none"
            parts.append(f'<text x="{x + cell / 2}" y="{y + cell / 2 + 4}" text-anchor="middle">{text}</text>')
    for i, curvature in enumerate(side):
        parts.append(f'<text x="{70 + i * cell + cell / 2}" y="{26 + n * cell}" text-anchor="middle">{curvature:.2f}</text>')
        parts.append(f'<text x="64" y="{14 + (n - 1 - i) * cell + cell / 2}" text-anchor="end">{curvature:.2f}</text>')
    middle = 70 + n * cell / 2
    parts.append(f'<text x="{middle}" y="{46 + n * cell}" text-anchor="middle">curvature of palm 1, 1/m (1/b1)</text>')
    parts.append(f'<text transform="translate(18 {10 + n * cell / 2}) rotate(-90)" text-anchor="middle">curvature of palm 2, 1/m (1/b2)</text>')
    return "\n".join(parts) + "\n</svg>\n"


if __name__ == "__main__":
    main()
