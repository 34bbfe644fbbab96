// How well the unknowns are observable over two coordinates, and along a line.

import { ask, element, refusal, shown } from "/ask.js";
import { COLORS, chart } from "/chart.js";
import { Values } from "/values.js";

const CELLS = 96;
/** A pointer that has not moved for so long rests, in ms. */
const RESTS = 150;

/** From light, which is well, to dark; of three tones between which every step is a step of light. */
function tone(part) {
    const stops = [[253, 231, 186], [221, 116, 105], [64, 22, 84]];
    const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1);
    const from = Math.min(Math.floor(at), stops.length - 2);
    return stops[from].map((low, channel) => low + (at - from) * (stops[from + 1][channel] - low));
}
const INFINITE = [0, 140, 110];
/** Deviations over the prior one from 1 to 1000 have tones of their own. */
const MOST = 3;

export class MapPanel {
    constructor(panel, lab) {
        Object.assign(this, { lab, panel, values: new Values(), view: new Map() });
        this.settings = element("div", { class: "row" });
        this.sliders = element("div", { class: "sliders", role: "group", "aria-label": "Values of what is fixed" });
        this.canvas = element("canvas", { width: CELLS, height: CELLS, tabindex: 0, role: "img", "aria-label": "Map; arrow keys move the pointer" });
        this.read = element("p", { class: "read", role: "status", "aria-live": "polite" });
        this.up = element("div", { class: "up" });
        this.across = element("div", { class: "across" });
        this.failure = element("div");
        this.line = element("div");
        this.lineAsked = element("div", { class: "row" });
        panel.append(
            element("p", { class: "hint" }, "How well the worst unknown, or one, is observable: its standard deviation over its prior one, where each Lie derivative is measured up to its own range (computed, not certified). Light is well; dark is badly; green is unobservable or not distinguishable from it; white is where something is undefined, as at a singularity. Where the pointer rests the rank is decided, by exact arithmetic at that very state."),
            this.settings, this.sliders, this.failure,
            element("div", { class: "axes" }, this.up, element("div", { class: "picture" }, this.canvas), this.across),
            element("div", { class: "scale", "aria-hidden": "true" }, ["1", "10", "100", "1000 and more", "infinite"].map(text => element("span", {}, text))),
            this.read, element("h2", {}, "Along a line"),
            element("p", { class: "hint" }, "The same towards where an expression is zero, such as a singular set, or towards infinity; from a distance of one down to 1e-12."),
            this.lineAsked, this.line);
        this.canvas.addEventListener("pointermove", event => this.point(event));
        this.canvas.addEventListener("click", event => { this.point(event); this.decide(); });
        this.canvas.addEventListener("pointerleave", () => clearTimeout(this.resting));
        this.canvas.addEventListener("keydown", event => this.key(event));
    }

    /** Another file is another system: nothing that was chosen is of it. */
    forget() {
        this.values.clear();
        this.x = this.y = this.of = null;
        this.drawnOf = null;
    }

    /** Takes in the symbols of a text; what is chosen stays, where it is still there. */
    update(draft) {
        this.draft = draft;
        if (!draft.sound || !draft.symbols) return;
        const key = JSON.stringify([draft.base, draft.maps]);
        if (key === this.drawnOf) return;
        this.drawnOf = key;
        this.isNew = true;
        // what was drawn of another system is no picture of this one
        this.abort?.abort();
        this.deciding?.abort();
        this.names = null;
        this.drawing?.abort();
        this.blank();
        const names = draft.symbols.map(symbol => symbol.name);
        const unknown = draft.symbols.filter(symbol => symbol.unknown).map(symbol => symbol.name);
        const states = draft.symbols.filter(symbol => symbol.kind === "state").map(symbol => symbol.name);
        const first = draft.maps?.[0];
        const kept = (name, other) => (names.includes(name) ? name : other);
        const [x, y] = [kept(this.x?.value, first?.x[0] ?? states[0] ?? names[0]), kept(this.y?.value, first?.y[0] ?? states[1] ?? names[1] ?? names[0])];
        const choose = (list, value, label) => {
            const found = element("select", { "aria-label": label, onchange: () => this.drawn() }, list.map(name => element("option", { value: name }, name || "the worst")));
            found.value = value;
            return found;
        };
        this.x = choose(names, x, "To the right");
        this.y = choose(names, y, "Upwards");
        this.of = choose(["", ...unknown], unknown.includes(this.of?.value) ? this.of.value : first?.of ?? "", "Which unknown");
        this.ranges = {};
        const range = (name, end) => {
            const view = [first?.x, first?.y].find(axis => axis?.[0] === name);
            const symbol = draft.symbols.find(symbol => symbol.name === name);
            return view ? view[end === "low" ? 1 : 2] : symbol?.[end];
        };
        const ends = axis => ["low", "high"].map(end => {
            const found = element("input", { type: "number", step: "any", "aria-label": `${axis}, ${end === "low" ? "least" : "greatest"} value`, onchange: () => this.drawn() });
            (this.ranges[axis] ??= {})[end] = found;
            return found;
        });
        this.put = () => {
            for (const [axis, select] of [["x", this.x], ["y", this.y]]) for (const end of ["low", "high"]) this.ranges[axis][end].value = Number(range(select.value, end)?.toPrecision(6));
        };
        this.settings.replaceChildren(
            element("label", {}, "to the right", this.x), ...ends("x"), element("label", {}, "upwards", this.y), ...ends("y"), element("label", {}, "of", this.of));
        this.put();
        for (const select of [this.x, this.y]) select.addEventListener("change", () => { this.put(); this.fixed(); }, { capture: true });
        this.view = new Map(Object.entries(first?.at ?? {}));
        this.fixed();
        this.lines(names);
        if (!this.panel.hidden) this.drawn();
    }

    /** Sliders for what is on neither axis. */
    fixed() {
        const rest = this.draft.symbols.filter(symbol => ![this.x.value, this.y.value].includes(symbol.name));
        this.sliders.replaceChildren(...rest.map(symbol => {
            const { name, low, high } = symbol;
            const value = this.valueOf(symbol);
            const told = element("output", {}, shown(value));
            const slider = element("input", {
                type: "range", min: Math.min(low, value), max: Math.max(high, value), step: (high - low) / 200 || "any", value, "aria-label": name,
                oninput: event => {
                    this.values.set(symbol, Number(event.target.value));
                    told.textContent = shown(Number(event.target.value));
                    this.drawn();
                },
            });
            return element("label", {}, name, slider, told);
        }));
    }

    /** What was chosen, else what the file's own map holds fixed, else the value of the text or the middle of its range. */
    valueOf(symbol) {
        return this.values.has(symbol) ? this.values.get(symbol) : this.view.get(symbol.name) ?? this.values.get(symbol);
    }

    at() {
        const rest = this.draft.symbols.filter(symbol => ![this.x.value, this.y.value].includes(symbol.name));
        return Object.fromEntries(rest.map(symbol => [symbol.name, this.valueOf(symbol)]));
    }

    axis(axis) {
        const select = axis === "x" ? this.x : this.y;
        return [select.value, Number(this.ranges[axis].low.value), Number(this.ranges[axis].high.value)];
    }

    shown() {
        if (this.isNew) this.drawn();
    }

    /** Draws anew, coarse first; what is being drawn is ended. */
    async drawn() {
        if (!this.draft?.sound || this.panel.hidden) return;
        this.isNew = false;
        this.canvas.dataset.done = false;
        this.abort?.abort();
        const abort = this.abort = new AbortController();
        const [x, y] = [this.axis("x"), this.axis("y")];
        this.failure.replaceChildren();
        this.deciding?.abort();
        clearTimeout(this.resting);
        // a picture stays only while its axes do
        const frame = JSON.stringify([x, y, this.of.value]);
        if (frame !== this.frame) this.blank();
        this.frame = frame;
        if (x[0] === y[0]) return this.failure.replaceChildren(element("p", { class: "hint" }, "Choose two different coordinates."));
        const question = { ask: "map", ...this.draft.question, x, y, at: this.at(), of: this.of.value || null, cells: CELLS };
        const ends = axis => [element("span", {}, shown(axis[1])), element("span", {}, axis[0]), element("span", {}, shown(axis[2]))];
        this.across.replaceChildren(...ends(x));
        this.up.replaceChildren(...ends(y));
        try {
            const found = await this.lab.quietly("the map", abort.signal, signal => ask("answer", question, { signal, line: line => line.kind === "map" && this.paint(line) }));
            this.names = found.names;
            this.canvas.dataset.done = true;
            this.told();
            if (this.place) this.rests();
        } catch (error) {
            if (error.name === "AbortError") return;
            this.blank();
            this.failure.replaceChildren(refusal(error));
        }
    }

    /** Nothing is drawn, and nothing is read. */
    blank() {
        this.grid = null;
        this.canvas.getContext("2d").clearRect(0, 0, this.canvas.width, this.canvas.height);
        this.read.textContent = "";
    }

    paint({ width, values, worst }) {
        this.grid = { width, values, worst };
        this.canvas.width = this.canvas.height = width;
        const context = this.canvas.getContext("2d");
        const image = context.createImageData(width, width);
        values.forEach((value, cell) => {
            const [column, row] = [cell % width, width - 1 - Math.floor(cell / width)];
            const color = value == null ? [255, 255, 255] : value < 0 ? INFINITE : tone(Math.log10(Math.max(value, 1)) / MOST);
            image.data.set([...color, 255], 4 * (row * width + column));
        });
        context.putImageData(image, 0, 0);
    }

    point(event) {
        const box = this.canvas.getBoundingClientRect();
        this.place = [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
        this.told();
        this.rests();
    }

    key(event) {
        const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
        if (event.key === "Enter") return this.decide();
        if (!(event.key in moves)) return;
        event.preventDefault();
        const [column, row] = moves[event.key];
        const place = this.place ?? [0.5, 0.5];
        this.place = [place[0] + column / 48, place[1] + row / 48].map(value => Math.min(Math.max(value, 0), 0.999));
        this.told();
        this.rests();
    }

    /** The state under the pointer. */
    state() {
        const value = (axis, part) => axis[1] + part * (axis[2] - axis[1]);
        const [x, y] = [this.axis("x"), this.axis("y")];
        return { ...this.at(), [x[0]]: value(x, this.place[0]), [y[0]]: value(y, this.place[1]) };
    }

    told() {
        if (!this.grid || !this.place) return;
        const { width, values, worst } = this.grid;
        const [column, row] = this.place.map(part => Math.min(Math.max(Math.floor(part * width), 0), width - 1));
        const cell = row * width + column;
        const [x, y] = [this.axis("x")[0], this.axis("y")[0]];
        const at = this.state();
        const value = values[cell];
        const name = worst[cell] == null || !this.names ? "" : this.of.value ? ` of ${this.of.value}` : ` of ${this.names[worst[cell]]}, the worst`;
        const told = value == null ? "something is undefined there, as at a singularity" : value < 0 ? `unobservable, or not distinguishable from it${name}` : `standard deviation over the prior one ${shown(value)}${name}`;
        this.read.textContent = `${x} = ${shown(at[x])}, ${y} = ${shown(at[y])}: ${told}`;
    }

    /** The certified rank under the pointer, when it rests. */
    rests() {
        clearTimeout(this.resting);
        this.resting = setTimeout(() => this.decide(), RESTS);
    }

    async decide() {
        clearTimeout(this.resting);
        if (!this.place || !this.grid) return;
        this.told();
        const before = this.read.textContent;
        const { place } = this;
        this.deciding?.abort();
        const { signal } = this.deciding = new AbortController();
        try {
            const found = await ask("answer", { ask: "state", ...this.draft.question, at: this.state() }, { signal });
            if (place !== this.place) return;
            const how = found.certified ? "certified" : "computed";
            this.read.textContent = `${before}; ${found.rank == null ? "there is no rank: a singularity, or not decided" : `rank ${found.rank} of ${found.dimension} (${how})`}`;
        } catch (error) {
            if (error.name !== "AbortError" && place === this.place) this.read.textContent = `${before}; ${error.message}`;
        }
    }

    lines(names) {
        const moving = element("select", { "aria-label": "The coordinate that moves" }, names.map(name => element("option", {}, name)));
        const zero = element("input", { placeholder: names[0] ?? "", "aria-label": "An expression that is zero at its end; empty for infinity", size: 16 });
        const go = element("button", { onclick: () => this.draw(moving.value, zero.value.trim()) }, "Draw");
        this.lineAsked.replaceChildren(element("label", {}, "moving", moving), element("label", {}, "to where", zero, "is zero (empty: to infinity)"), go);
        this.line.replaceChildren();
    }

    async draw(moving, zero) {
        const at = { ...this.at() };
        // the other axis is held where the pointer is
        if (this.place) Object.assign(at, this.state());
        for (const axis of ["x", "y"]) {
            const [name, low, high] = this.axis(axis);
            at[name] ??= (low + high) / 2;
        }
        delete at[moving];
        this.drawing?.abort();
        const drawing = this.drawing = new AbortController();
        try {
            const found = await this.lab.run("the line", (signal, line) => ask("answer", { ask: "line", ...this.draft.question, moving, zero: zero || null, at }, { signal, line }), drawing);
            const curves = found.names.map((name, place) => ({
                name, color: COLORS[place % COLORS.length], x: found.distance, y: found.values.map(all => (all && all[place] > 0 ? all[place] : NaN)), dash: place >= COLORS.length ? "5 3" : null,
            }));
            const missing = found.names.filter((_, place) => found.values.some(all => all && all[place] < 0));
            this.line.replaceChildren(
                chart({ curves, x: zero ? `distance of ${moving} from where ${zero} is zero` : `one over ${moving}`, y: "standard deviation / prior", log: [true, true], label: "Standard deviations along the line" }),
                element("p", { class: "hint" }, missing.length ? `Where a curve of ${missing.join(", ")} ends it is infinite or not distinguishable from that.` : ""));
        } catch (error) {
            if (drawing === this.drawing) this.line.replaceChildren(error.name === "AbortError" ? "stopped" : refusal(error));
        }
    }
}
