// Curves in one frame, as SVG.

import { element, shown } from "/ask.js";

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 560, HEIGHT = 300, LEFT = 58, RIGHT = 10, TOP = 10, BOTTOM = 36;

function drawn(name, attributes, text) {
    const found = document.createElementNS(SPACE, name);
    for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
    if (text != null) found.textContent = text;
    return found;
}

/** Round places between two ends. */
function ticks(low, high, log) {
    if (log) {
        const found = [];
        const step = Math.max(1, Math.ceil((high - low) / 7));
        for (let power = Math.ceil(low); power <= high; power += step) found.push(power);
        // within a decade or two there are places between the powers
        const between = [1, 2, 5].flatMap(digit => [Math.floor(low), Math.ceil(low)].map(power => Math.log10(digit) + power)).filter(at => at >= low && at <= high);
        return found.length > 1 ? found : between.sort((a, b) => a - b);
    }
    const raw = (high - low) / 5;
    const size = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map(factor => factor * size).find(step => step >= raw);
    const found = [];
    for (let at = Math.ceil(low / step) * step; at <= high + step * 1e-9; at += step) found.push(Math.abs(at) < step * 1e-9 ? 0 : at);
    return found;
}

function ends(values, log) {
    let low = Infinity, high = -Infinity;
    for (const value of values) {
        if (!Number.isFinite(value)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
    }
    if (!(low <= high)) return [0, 1];
    if (low === high) {
        const far = log ? 1 : Math.abs(low) / 2 || 1;
        return [low - far, high + far];
    }
    const margin = (high - low) * 0.04;
    return [low - margin, high + margin];
}

/**
 * A chart of curves `{ name, x, y, color, dash, dots }`; on `log` axes by powers of ten. `onpoint` gets the place of a click.
 */
export function chart({ curves, x, y, label, log = [false, false], onpoint, marks = [] }) {
    const put = [log[0] ? Math.log10 : value => value, log[1] ? Math.log10 : value => value];
    const all = side => curves.flatMap(curve => Array.from(curve[side], put[side === "x" ? 0 : 1])).concat(marks.map(mark => put[side === "x" ? 0 : 1](mark[side])));
    const range = [ends(all("x"), log[0]), ends(all("y"), log[1])];
    const across = value => LEFT + (put[0](value) - range[0][0]) / (range[0][1] - range[0][0]) * (WIDTH - LEFT - RIGHT);
    const down = value => HEIGHT - BOTTOM - (put[1](value) - range[1][0]) / (range[1][1] - range[1][0]) * (HEIGHT - TOP - BOTTOM);
    const svg = drawn("svg", { class: "chart", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label });
    const name = (value, log) => !log ? shown(value, 3) : Number.isInteger(value) && Math.abs(value) > 2 ? `1e${value}` : shown(10 ** value, 2);
    for (const at of ticks(...range[0], log[0])) {
        const place = across(log[0] ? 10 ** at : at);
        svg.append(drawn("line", { class: "grid", x1: place, x2: place, y1: TOP, y2: HEIGHT - BOTTOM }));
        svg.append(drawn("text", { x: place, y: HEIGHT - BOTTOM + 14, "text-anchor": "middle" }, name(at, log[0])));
    }
    for (const at of ticks(...range[1], log[1])) {
        const place = down(log[1] ? 10 ** at : at);
        svg.append(drawn("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: place, y2: place }));
        svg.append(drawn("text", { x: LEFT - 5, y: place + 4, "text-anchor": "end" }, name(at, log[1])));
    }
    svg.append(drawn("rect", { class: "frame", x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM }));
    svg.append(drawn("text", { x: (LEFT + WIDTH) / 2, y: HEIGHT - 5, "text-anchor": "middle" }, x));
    if (y) svg.append(drawn("text", { x: 12, y: (HEIGHT - BOTTOM) / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${(HEIGHT - BOTTOM) / 2})` }, y));
    for (const curve of curves) {
        // a curve is broken where it has no value
        let part = [];
        const parts = [part];
        curve.x.forEach((value, place) => {
            const at = [across(value), down(curve.y[place])];
            if (at.every(Number.isFinite)) part.push(at);
            else parts.push(part = []);
        });
        for (const points of parts.filter(part => part.length > 0)) {
            const text = points.map(point => point.map(value => value.toFixed(1)).join(",")).join(" ");
            svg.append(drawn("polyline", { points: text, style: `stroke: ${curve.color}`, "stroke-dasharray": curve.dash ?? "none" }));
        }
        if (curve.dots) {
            for (const [cx, cy] of parts.flat()) svg.append(drawn("circle", { cx, cy, r: 1.6, style: `fill: ${curve.color}` }));
        }
    }
    for (const mark of marks) svg.append(drawn("circle", { cx: across(mark.x), cy: down(mark.y), r: 4.5, style: `fill: ${mark.color}` }));
    if (onpoint) {
        svg.style.cursor = "crosshair";
        svg.addEventListener("click", event => {
            const box = svg.getBoundingClientRect();
            const place = [(event.clientX - box.left) / box.width * WIDTH, (event.clientY - box.top) / box.height * HEIGHT];
            const at = (value, low, high, range) => range[0] + (value - low) / (high - low) * (range[1] - range[0]);
            onpoint(at(place[0], LEFT, WIDTH - RIGHT, range[0]), at(place[1], HEIGHT - BOTTOM, TOP, range[1]));
        });
    }
    const legend = element("div", { class: "legend" }, curves.filter(curve => curve.name).map(curve =>
        element("span", {}, element("i", { style: `border-top-style: ${curve.dash ? "dashed" : "solid"}; border-top-color: ${curve.color}` }), curve.name)));
    return element("div", {}, svg, legend);
}

/** Colours that are told apart by people who see few of them. */
export const COLORS = ["var(--first)", "var(--second)", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7f7f7f"];
