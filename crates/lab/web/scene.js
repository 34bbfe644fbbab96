// A body between two palms as it moves: where it touches them, and the outline that was recovered from these touches.

import { element, shown } from "/ask.js";

const SPACE = "http://www.w3.org/2000/svg";
/** The motion is shown in so many seconds. */
const SECONDS = 8;

function drawn(name, attributes = {}) {
    const found = document.createElementNS(SPACE, name);
    for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
    return found;
}

function rows(csv) {
    const [head, ...lines] = csv.trim().split("\n").map(line => line.split(","));
    return lines.map(line => Object.fromEntries(head.map((name, place) => [name, Number(line[place])])));
}

/** The boundary point with an outward normal of direction `u`, of the support function that was recovered. */
function outline({ mean_radius: mean, harmonics }, u) {
    let [h, slope] = [mean, 0];
    harmonics.forEach(([p, q], place) => {
        const k = place + 1;
        h += p * Math.cos(k * u) + q * Math.sin(k * u);
        slope += k * (q * Math.cos(k * u) - p * Math.sin(k * u));
    });
    return [h * Math.cos(u) - slope * Math.sin(u), h * Math.sin(u) + slope * Math.cos(u)];
}

/** The radii of the palms that a scene states; flat palms have none. */
function radii(scene) {
    const palms = scene.split(/^\[/m).find(part => part.startsWith("palms]")) ?? "";
    const found = palms.match(/^radii\s*=\s*\[([^\]]*)\]/m)?.[1].split(",").map(Number);
    return found?.length === 2 && found.every(radius => radius !== 0 && Number.isFinite(radius)) ? found : [Infinity, Infinity];
}

/** Where a palm has a length of arc `s` from the joint, and its tangent there: palm 1 bends to the left, palm 2 to the right. */
function onPalm(at, bends, palm, s) {
    const begin = palm === 0 ? at.phi1 : at.phi1 + at.phi2;
    const bend = palm === 0 ? 1 / bends[0] : -1 / bends[1];
    const angle = begin + bend * s;
    const place = bend === 0 ? [s * Math.cos(angle), s * Math.sin(angle)] : [(Math.sin(angle) - Math.sin(begin)) / bend, (Math.cos(begin) - Math.cos(angle)) / bend];
    return [place, angle];
}

/** The two contacts at a moment: in the world, in the body's frame, and the direction of the normal there. */
function contacts(at, bends) {
    return [at.s1, at.s2].map((s, palm) => {
        const [world, angle] = onPalm(at, bends, palm, s);
        const [x, y] = [world[0] - at.x, world[1] - at.y];
        const [c, d] = [Math.cos(at.phi0), Math.sin(at.phi0)];
        // the body lies to the left of palm 1 and to the right of palm 2
        const normal = angle + (palm === 0 ? -Math.PI / 2 : Math.PI / 2) - at.phi0;
        return { world, body: [c * x + d * y, c * y - d * x], normal };
    });
}

/** A moving picture of a scene, where there is one to be drawn; nothing otherwise. */
export function movingScene(csv, shape, scene) {
    const moments = rows(csv);
    const bends = radii(scene);
    if (moments.length < 2 || !("phi0" in moments[0]) || !Array.isArray(shape?.harmonics)) return null;
    const touches = moments.map(at => contacts(at, bends));
    // where the origin of the recovered outline lies in the body is not determined by touch: it is put where the contacts are
    const shift = [0, 1].map(axis => touches.flat().reduce((sum, touch) => sum + touch.body[axis] - outline(shape, touch.normal)[axis], 0) / (2 * touches.length));
    const points = Array.from({ length: 181 }, (_, place) => outline(shape, place * Math.PI / 90).map((value, axis) => value + shift[axis]));
    const far = Math.max(...moments.flatMap(at => [at.s1, at.s2])) * 1.25;
    const turned = (at, [x, y]) => {
        const [c, d] = [Math.cos(at.phi0), Math.sin(at.phi0)];
        return [at.x + c * x - d * y, at.y + d * x + c * y];
    };
    const lengths = bends.map(bend => Math.min(far, 3 * Math.abs(bend)));
    const along = (at, palm) => Array.from({ length: 25 }, (_, place) => onPalm(at, bends, palm, lengths[palm] * place / 24)[0]);
    // what does not lie where it touches is not drawn
    const off = Math.max(...touches.flat().map(touch => {
        const at = outline(shape, touch.normal);
        return Math.hypot(at[0] + shift[0] - touch.body[0], at[1] + shift[1] - touch.body[1]);
    }));
    if (!(off < 0.02 * far)) return null;
    const size = 420;
    // all of the motion is within the frame, to one scale
    const some = moments.filter((_, place) => place % Math.ceil(moments.length / 30) === 0);
    const seen = [[0, 0], ...some.flatMap(at => [...along(at, 0), ...along(at, 1), ...points.filter((_, place) => place % 6 === 0).map(point => turned(at, point))])];
    const [low, high] = [Math.min, Math.max].map(most => [0, 1].map(axis => most(...seen.map(point => point[axis]))));
    const scale = 0.94 * size / Math.max(high[0] - low[0], high[1] - low[1]);
    const put = ([x, y]) => [size / 2 + scale * (x - (low[0] + high[0]) / 2), size / 2 - scale * (y - (low[1] + high[1]) / 2)].map(value => value.toFixed(1));
    const svg = drawn("svg", { viewBox: `0 0 ${size} ${size}`, class: "chart", role: "img", "aria-label": "The body between its palms, with the contacts and the recovered outline", style: "max-width: 30rem" });
    const body = drawn("polygon", { style: "fill: color-mix(in srgb, var(--soft) 18%, transparent); stroke: var(--soft)" });
    const palms = [0, 1].map(palm => drawn("polyline", { class: "palm", style: `stroke: var(--${palm === 0 ? "first" : "second"}); stroke-width: 3; opacity: .6` }));
    const trails = [0, 1].map(palm => drawn("polyline", { class: "trail", style: `stroke: var(--${palm === 0 ? "first" : "second"}); stroke-width: 4` }));
    const lights = [0, 1].map(() => drawn("circle", { r: 7, style: "fill: #e69f00; stroke: var(--ink)" }));
    svg.append(body, ...palms, ...trails, ...lights);
    const time = element("input", { type: "range", min: 0, max: moments.length - 1, step: 1, value: 0, "aria-label": "Time" });
    const told = element("output");
    const show = place => {
        const at = moments[place];
        const world = point => put(turned(at, point)).join(",");
        body.setAttribute("points", points.map(world).join(" "));
        touches[place].forEach((touch, palm) => {
            palms[palm].setAttribute("points", along(at, palm).map(point => put(point).join(",")).join(" "));
            const [cx, cy] = put(touch.world);
            lights[palm].setAttribute("cx", cx);
            lights[palm].setAttribute("cy", cy);
            trails[palm].setAttribute("points", touches.slice(0, place + 1).map(all => world(all[palm].body)).join(" "));
        });
        time.value = place;
        told.textContent = `${shown(at.time, 3)} s`;
    };
    let begin = null;
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const play = element("button", { onclick: () => (begin == null ? start() : stop()) }, "Play");
    const stop = () => { begin = null; play.textContent = "Play"; };
    const step = now => {
        if (begin == null || !svg.isConnected) return;
        const part = Math.max((now - begin) / (1000 * SECONDS), 0);
        show(Math.min(Math.floor(part * moments.length), moments.length - 1));
        if (part >= 1) stop();
        else requestAnimationFrame(step);
    };
    const start = () => {
        play.textContent = "Pause";
        begin = performance.now() - (Number(time.value) >= moments.length - 1 ? 0 : Number(time.value) / moments.length * 1000 * SECONDS);
        requestAnimationFrame(step);
    };
    time.addEventListener("input", () => { stop(); show(Number(time.value)); });
    show(0);
    if (!calm) requestAnimationFrame(start);
    return element("figure", {}, svg, element("div", { class: "row" }, play, time, told),
        element("figcaption", {}, "In grey the outline that was recovered, in blue and orange what has touched a palm so far, as measured. The pose is that of the simulation; where the outline lies in the body touch does not tell, so that it is put where the contacts are."));
}
