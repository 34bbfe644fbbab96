"""Tables and a picture of what `unknowns.py` measured."""

import math

OURS, PLAIN, STRIKEPY = "palmistry", "plain Python", "StrikePy"
COLORS = ["#1668a8", "#c8501e", "#2c8a4b", "#8a4bb0", "#a8871a", "#5a5a5a"]


def seconds(result, reference=None):
    if result is None:
        return ""
    if result["seconds"] is None:
        return result["why"]
    ratio = f" ({figures(result['seconds'] / reference['seconds'])})" if reference and reference["seconds"] else ""
    return f"{figures(result['seconds'])}{ratio}"


def figures(value):
    """Two digits, and no decimals from ten on."""
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def tables(report):
    lines = [
        "| seconds of the processor (ratio to ours) | unknowns | palmistry | its memory, MB | plain Python | StrikePy |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for curve in report["families"]:
        for point in curve["points"]:
            ours = point.get(OURS)
            memory = "" if not ours or ours["megabytes"] is None else f"{ours['megabytes']:.0f}"
            lines.append(
                f"| {curve['title']} | {point['unknowns']} | {seconds(ours)} | {memory} | {seconds(point.get(PLAIN), ours)} | "
                f"{seconds(point.get(STRIKEPY), ours)} |"
            )
    done = [point for point in report["models"] if point[STRIKEPY] and point[STRIKEPY]["seconds"] is not None]
    lines += [
        "",
        f"Of {len(report['models'])} published models (`tests/models`) with {min(p['unknowns'] for p in report['models'])} to "
        f"{max(p['unknowns'] for p in report['models'])} unknowns StrikePy decides {len(done)} within {report['limit']:g} s; "
        f"{summary(report, OURS)}, {summary(report, PLAIN)}.",
        "",
        "| model | unknowns | rank | palmistry | plain Python | StrikePy |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for point in report["models"]:
        ours = point[OURS]
        lines.append(
            f"| {point['model']} | {point['unknowns']} | {point['rank']} | {seconds(ours)} | {seconds(point[PLAIN], ours)} | "
            f"{seconds(point[STRIKEPY], ours)} |"
        )
    return "\n".join([*lines, "", headline(report)])


def summary(report, program):
    times = [
        point[program]["seconds"] for point in report["models"] if point[program] and point[program]["seconds"] is not None
    ]
    return f"{program} {len(times)} in {figures(sum(times))} s altogether"


def headline(report):
    machine = report["machine"]
    return (
        f"{machine['processor']}, one core; palmistry {machine['palmistry']}; Python {machine['python']}, numpy {machine['numpy']}, "
        f"sympy {machine['sympy']}, StrikePy {machine['StrikePy']}, symbtools {machine['symbtools']}; ours as a whole process, "
        "the two in Python without the start of their interpreter; least of three."
    )


def picture(report):
    """Seconds over unknowns, both on logarithmic axes: ours drawn through, the plain test dashed, StrikePy as dots."""
    width, height, left, bottom, top, right = 720, 400, 60, 50, 20, 230
    points = [
        (point["unknowns"], result["seconds"])
        for curve in report["families"]
        for point in curve["points"]
        for result in (point.get(OURS), point.get(PLAIN), point.get(STRIKEPY))
        if result and result["seconds"]
    ]
    low, high = math.floor(math.log10(min(y for _, y in points))), math.ceil(math.log10(max(y for _, y in points)))
    first, last = math.log10(min(x for x, _ in points)), math.log10(max(x for x, _ in points))
    across = lambda x: left + (math.log10(x) - first) / (last - first) * (width - left - right)
    up = lambda y: height - bottom - (math.log10(y) - low) / (high - low) * (height - bottom - top)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="seconds over unknowns" '
        'font-family="system-ui,sans-serif" font-size="12">',
        '<rect width="100%" height="100%" rx="8" fill="#fff"/>',
    ]
    for power in range(low, high + 1):
        y = up(10.0**power)
        out.append(
            f'<path d="M{left} {y:.1f}H{width - right}" stroke="#ddd"/><text x="{left - 6}" y="{y + 4:.1f}" '
            f'text-anchor="end">{10.0**power:g} s</text>'
        )
    for x in sorted({point["unknowns"] for point in report["families"][0]["points"]}):
        out.append(f'<text x="{across(x):.1f}" y="{height - bottom + 18}" text-anchor="middle">{x}</text>')
    out.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 12}" text-anchor="middle">unknowns</text>')
    for color, curve in zip(COLORS, report["families"]):
        for program, dash in ((OURS, ""), (PLAIN, ' stroke-dasharray="5 4"')):
            line = " ".join(
                f"{across(p['unknowns']):.1f},{up(p[program]['seconds']):.1f}"
                for p in curve["points"]
                if p.get(program) and p[program]["seconds"]
            )
            if line:
                out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"{dash}/>')
        for point in curve["points"]:
            if point.get(STRIKEPY) and point[STRIKEPY]["seconds"]:
                out.append(
                    f'<circle cx="{across(point["unknowns"]):.1f}" cy="{up(point[STRIKEPY]["seconds"]):.1f}" r="4" fill="{color}"/>'
                )
    for row, (color, curve) in enumerate(zip(COLORS, report["families"])):
        y = top + 20 + 20 * row
        out.append(
            f'<path d="M{width - right + 14} {y}h20" stroke="{color}" stroke-width="3"/>'
            f'<text x="{width - right + 40}" y="{y + 4}">{curve["title"].split(",")[0]}</text>'
        )
    y = top + 30 + 20 * len(report["families"])
    for row, words in enumerate(
        ["through: palmistry", "dashed: plain Python, numpy", f"dots: StrikePy, within {report['limit']:g} s"]
    ):
        out.append(f'<text x="{width - right + 14}" y="{y + 18 * row}">{words}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"
