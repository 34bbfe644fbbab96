// Motions of the system: from a state that is chosen, and from a second one whose outputs are the same.

import { ask, element, refusal, shown } from "/ask.js";
import { COLORS, chart } from "/chart.js";
import { Values } from "/values.js";

/** A waiting time after the last change, so that a slider that is being moved asks not for every step. */
const QUIET = 60;

export class Motion {
    constructor(panel, lab) {
        Object.assign(this, { lab, panel, values: new Values(), functions: new Map() });
        this.duration = element("input", { type: "number", value: 10, min: 0, step: "any", "aria-label": "Duration", onchange: () => this.later() });
        this.sliders = element("div", { class: "sliders", role: "group", "aria-label": "Start and parameters" });
        this.inputs = element("div", { class: "row", role: "group", "aria-label": "Inputs" });
        this.axes = element("div", { class: "row" });
        this.second = element("div", { class: "row" });
        this.told = element("p", { class: "hint", role: "status" });
        this.pictures = element("div");
        panel.append(
            element("p", { class: "hint" }, "The system moves from the start below. Where an unobservable direction is known, a second start along it gives other states and the same outputs. A click into the phase portrait puts the start there."),
            element("div", { class: "row" }, element("label", {}, "duration", this.duration)), this.inputs, this.sliders, this.second, this.axes, this.told, this.pictures);
    }

    /** Another file is another system: nothing that was chosen is of it. */
    forget() {
        this.values.clear();
        this.functions.clear();
        this.x = this.y = this.base = null;
    }

    update(draft) {
        this.draft = draft;
        if (!draft.sound || !draft.symbols || draft.base === this.base) return;
        this.base = draft.base;
        this.isNew = true;
        // what moves is another system
        this.abort?.abort();
        this.told.textContent = "";
        this.sliders.replaceChildren(...draft.symbols.filter(symbol => !symbol.signal).map(symbol => this.slider(symbol)));
        this.drives = draft.fields?.filter(field => field.role === "input").map(field => field.name) ?? [];
        this.drives.push(...(draft.signals ?? []));
        for (const name of this.drives) if (!this.functions.has(name)) this.functions.set(name, "sin(t)");
        this.inputs.replaceChildren(...this.drives.map(name => element("label", {}, name, element("input", {
            value: this.functions.get(name), size: 14, "aria-label": `${name} as a function of the time t`, onchange: event => { this.functions.set(name, event.target.value); this.later(); },
        }))), this.drives.length ? element("span", { class: "hint" }, "functions of the time t") : "");
        const states = draft.symbols.filter(symbol => symbol.kind === "state" && !symbol.signal).map(symbol => symbol.name);
        const choose = (value, label) => {
            const found = element("select", { "aria-label": label, onchange: () => this.draw() }, states.map(name => element("option", {}, name)));
            if (value) found.value = value;
            return found;
        };
        const kept = (select, other) => (states.includes(select?.value) ? select.value : other);
        this.x = choose(kept(this.x, states[0]), "Phase portrait, to the right");
        this.y = choose(kept(this.y, states[1] ?? states[0]), "Phase portrait, upwards");
        this.axes.replaceChildren(element("label", {}, "phase portrait of", this.x), element("label", {}, "and", this.y));
        this.along = null;
        this.second.replaceChildren();
        this.found = null;
        this.pictures.replaceChildren();
        if (!this.panel.hidden) this.later();
    }

    slider(symbol) {
        const { name, low, high } = symbol;
        const value = this.valueOf(symbol);
        const told = element("output", {}, shown(value));
        const slider = element("input", {
            type: "range", min: Math.min(low, value), max: Math.max(high, value), step: (high - low) / 200 || "any", value, "aria-label": symbol.kind === "state" ? `${name} at the start` : name, "data-name": name,
            oninput: event => {
                this.values.set(symbol, Number(event.target.value));
                told.textContent = shown(Number(event.target.value));
                this.later();
            },
        });
        return element("label", {}, name, slider, told);
    }

    /** A motion begins off the middle, where many systems rest. */
    valueOf(symbol) {
        return this.values.get(symbol, 0.7);
    }

    start() {
        return Object.fromEntries(this.draft.symbols.filter(symbol => !symbol.signal).map(symbol => [symbol.name, this.valueOf(symbol)]));
    }

    driven() {
        return Object.fromEntries(this.drives.map(name => [name, this.functions.get(name) ?? ""]));
    }

    shown() {
        if (this.isNew) this.later();
    }

    later() {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.move(), QUIET);
    }

    async move() {
        if (!this.draft?.sound || this.panel.hidden) return;
        this.isNew = false;
        this.abort?.abort();
        const abort = this.abort = new AbortController();
        const question = { ask: "motion", ...this.draft.question, start: this.start(), inputs: this.driven(), duration: Number(this.duration.value), samples: 400, along: this.along };
        try {
            this.found = await this.lab.quietly("the motion", abort.signal, signal => ask("answer", question, { signal }));
            this.offer();
            this.draw();
        } catch (error) {
            if (error.name === "AbortError") return;
            this.pictures.replaceChildren(refusal(error));
            this.told.textContent = "";
        }
    }

    /** The second start: along which field, and how far. */
    offer() {
        const { fields } = this.found;
        if (this.second.childElementCount > 0) return;
        if (fields.length === 0) {
            this.second.replaceChildren(element("span", { class: "hint" }, "No unobservable direction is known as a vector field: there is no second start to show."));
            return;
        }
        const which = element("select", { "aria-label": "Unobservable direction", onchange: () => change() }, fields.map((text, place) => element("option", { value: place }, text)));
        const far = element("input", { type: "range", min: -2, max: 2, step: 0.02, value: 1, "aria-label": "How far the second start lies along it", oninput: () => change() });
        const told = element("output", {}, "1");
        const change = () => {
            this.along = [Number(which.value), Number(far.value)];
            told.textContent = far.value;
            this.later();
        };
        this.second.replaceChildren(element("label", {}, "second start along", which), element("label", {}, far, told));
        this.along = [0, 1];
        this.later();
    }

    draw() {
        const { found } = this;
        if (!found) return;
        const column = (list, name) => list.find(one => one.name === name)?.values ?? [];
        const motions = [[found, "first start", COLORS[0], null], ...(found.second ? [[found.second, "second start", COLORS[1], "6 4"]] : [])];
        const portrait = motions.map(([motion, name, color, dash]) => ({ name, color, dash, x: column(motion.states, this.x.value), y: column(motion.states, this.y.value) }));
        const starts = portrait.filter(curve => curve.x.length > 0).map(curve => ({ x: curve.x[0], y: curve.y[0], color: curve.color }));
        const put = (x, y) => {
            for (const [select, value] of [[this.x, x], [this.y, y]]) {
                this.values.set(this.draft.symbols.find(symbol => symbol.name === select.value), value);
                const slider = this.sliders.querySelector(`input[data-name="${CSS.escape(select.value)}"]`);
                if (slider) {
                    slider.min = Math.min(slider.min, value);
                    slider.max = Math.max(slider.max, value);
                    slider.value = value;
                    slider.nextElementSibling.textContent = shown(value);
                }
            }
            this.later();
        };
        const outputs = found.outputs.map((output, place) => {
            const curves = motions.map(([motion, name, color, dash]) => ({ name: motions.length > 1 ? name : null, color, dash, x: motion.times, y: motion.outputs[place]?.values ?? [] }));
            return element("figure", {}, chart({ curves, x: "time", y: output.name, label: `The output ${output.name} over time` }));
        });
        const parts = [];
        if (found.ended) parts.push(`The motion ends early: ${found.ended}.`);
        if (found.second) {
            const first = this.start();
            const start = Object.entries(found.second.start).filter(([name, value]) => Math.abs(value - first[name]) > 1e-12);
            parts.push(`Second start: ${start.map(([name, value]) => `${name} = ${shown(value)}`).join(", ")}. The outputs of both differ by ${found.second.difference.toExponential(1)} of their size${found.second.ended ? `, as far as both go, until ${shown(found.second.compared_until)}: the second ends early, ${found.second.ended}` : ""}.`);
        }
        this.told.textContent = parts.join(" ");
        this.pictures.replaceChildren(
            element("figure", {}, chart({ curves: portrait, marks: starts, x: this.x.value, y: this.y.value, label: "Phase portrait", onpoint: put })), ...outputs);
    }
}
