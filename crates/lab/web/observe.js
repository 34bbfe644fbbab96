// Estimates from a recording that is dropped here, or from a simulated one whose noise and length are sliders.

import { ask, element, refusal, shown } from "/ask.js";
import { COLORS, chart } from "/chart.js";

const QUIET = 250;
/** Longer recordings are for the command. */
const LONGEST = 24 << 20;

/** The heads and the first rows of a table. */
function table(csv) {
    const lines = csv.split(/\r\n|\n|\r/).filter(line => line.trim() && !line.startsWith("#"));
    const separator = [",", ";", "\t"].map(sign => [sign, (lines[0] ?? "").split(sign).length]).sort((a, b) => b[1] - a[1])[0][0];
    const cells = line => line.split(separator).map(cell => cell.trim().replace(/^"(.*)"$/, "$1"));
    return { heads: cells(lines[0] ?? ""), rows: lines.length - 1 };
}

export class Observe {
    constructor(panel, lab) {
        Object.assign(this, { lab, panel, chosen: new Set(), trade: [], csv: null, columns: new Map() });
        const number = (name, value, attributes, label) => {
            const told = element("output", {}, shown(attributes.log ? 10 ** value : value));
            const slider = element("input", {
                type: "range", min: attributes.min, max: attributes.max, step: attributes.step, value, "aria-label": label,
                oninput: () => { told.textContent = shown(this.value(name)); this.later(); },
            });
            this.sliders_ ??= {};
            this.sliders_[name] = { slider, log: attributes.log };
            return element("label", {}, label, slider, told);
        };
        this.source = element("div", { class: "row" });
        this.file = element("input", { type: "file", accept: ".csv,.txt,.tsv", "aria-label": "A recording as CSV", onchange: () => this.file.files[0] && this.taken(this.file.files[0]) });
        this.simulated = element("div", { class: "sliders" }, number("noise", -2, { min: -6, max: 0, step: 0.1, log: true }, "noise"),
            number("duration", 10, { min: 1, max: 100, step: 1 }, "duration"), number("samples", 200, { min: 10, max: 2000, step: 10 }, "samples"));
        this.windows = element("div", { class: "sliders" }, number("window", 100, { min: 5, max: 100, step: 5 }, "window, %"), number("seed", 1, { min: 1, max: 50, step: 1 }, "seed"));
        this.method = element("select", { "aria-label": "Method", onchange: () => this.later() },
            [["", "the default"], ["multiple-shooting", "multiple shooting"], ["trust-region", "trust region"], ["unscented", "unscented Kalman filter"], ["kalman", "extended Kalman filter"], ["smoother", "smoother"], ["integration", "the first guess, carried along"]].map(([value, name]) => element("option", { value }, name)));
        this.mapped = element("div", { class: "row" });
        this.unknowns = element("fieldset", {}, element("legend", {}, "to be estimated"));
        this.result = element("div");
        this.fit = element("div", { class: "row" });
        const go = element("button", { onclick: () => this.estimate() }, "Estimate");
        this.live = element("input", { type: "checkbox", checked: true });
        panel.append(
            element("p", { class: "hint" }, "Drop a recording here (CSV with a column of the time), or estimate from a simulation that starts as under Motion. The sliders show what noise and length cost in accuracy, and the window what it costs in time."),
            element("div", { class: "row" }, element("label", {}, "recording", this.file), element("button", { onclick: () => this.taken(null) }, "Simulate instead")),
            this.source, this.mapped, this.simulated, this.unknowns, this.windows,
            element("div", { class: "row" }, element("label", {}, "method", this.method), go, element("label", {}, this.live, "at each change")),
            this.fit, this.result);
        panel.addEventListener("dragover", event => { event.preventDefault(); panel.classList.add("dropping"); });
        panel.addEventListener("dragleave", () => panel.classList.remove("dropping"));
        panel.addEventListener("drop", event => {
            event.preventDefault();
            event.stopPropagation();
            panel.classList.remove("dropping");
            const files = [...event.dataTransfer.files];
            if (files.length === 1 && /\.(csv|tsv|txt)$/i.test(files[0].name)) this.taken(files[0]);
            else this.lab.take(files);
        });
    }

    /** A problem of parameter estimation that was imported: it is fitted as its files state it, whatever the text has become. */
    problem(files, { measured, experiments }) {
        const button = element("button", { onclick: () => this.fitted(files) }, "Fit the imported problem");
        this.fit.replaceChildren(button, element("span", { class: "hint" }, `as its files state it: ${measured} measurements of ${experiments} ${experiments === 1 ? "experiment" : "experiments"}, from several starts`));
    }

    async fitted(files) {
        clearTimeout(this.timer);
        this.abort?.abort();
        const abort = this.abort = new AbortController();
        try {
            const { page } = await this.lab.run("the fit", signal => ask("answer", { ask: "fit", files }, { signal }), abort);
            this.result.replaceChildren(element("iframe", { src: `/page/${page}`, title: "The fit: parameters, profiles, residuals", sandbox: "allow-scripts" }));
        } catch (error) {
            if (error.name !== "AbortError") this.result.replaceChildren(refusal(error));
        }
    }

    /** Another file is another system. */
    forget() {
        this.fit.replaceChildren();
        this.base = null;
        this.columns.clear();
    }

    value(name) {
        const { slider, log } = this.sliders_[name];
        return log ? 10 ** Number(slider.value) : Number(slider.value);
    }

    update(draft) {
        this.draft = draft;
        if (!draft.sound || !draft.symbols || draft.base === this.base) return;
        this.base = draft.base;
        this.isNew = true;
        this.abort?.abort();
        const outputs = new Set(draft.outputs ?? []);
        const box = symbol => {
            const isChosen = symbol.unknown && !outputs.has(symbol.name);
            if (isChosen) this.chosen.add(symbol.name);
            else this.chosen.delete(symbol.name);
            return element("label", {}, element("input", {
                type: "checkbox", checked: isChosen, value: symbol.name,
                onchange: event => { event.target.checked ? this.chosen.add(symbol.name) : this.chosen.delete(symbol.name); this.later(); },
            }), symbol.name);
        };
        this.chosen.clear();
        this.unknowns.replaceChildren(element("legend", {}, "to be estimated"), element("div", { class: "row" }, draft.symbols.filter(symbol => !symbol.signal).map(box)));
        this.result.replaceChildren();
        this.trade = [];
        this.map();
        this.later();
    }

    shown() {
        if (this.isNew) this.later();
    }

    async taken(file) {
        this.result.replaceChildren();
        if (file && file.size > LONGEST) {
            this.result.replaceChildren(element("p", { class: "bad" }, "This recording is longer than 24 MiB: use the command 'palmistry observe'."));
            return;
        }
        this.csv = file ? await file.text() : null;
        this.trade = [];
        this.name = file?.name;
        if (!file) this.file.value = "";
        this.columns.clear();
        this.map();
        this.later();
    }

    /** Which column is which signal. */
    map() {
        this.simulated.hidden = this.csv != null;
        this.mapped.replaceChildren();
        if (this.csv == null) {
            this.source.replaceChildren(element("span", { class: "hint" }, "simulated, from the start under Motion"));
            return;
        }
        const { heads, rows } = table(this.csv);
        this.source.replaceChildren(element("span", {}, `${this.name}: ${rows} rows; columns ${heads.join(", ")}`));
        const wanted = ["time", ...(this.draft?.outputs ?? []), ...(this.draft?.signals ?? []), ...(this.draft?.fields ?? []).filter(field => field.role === "input").map(field => field.name)];
        const near = name => heads.find(head => head === name) ?? heads.find(head => head.toLowerCase() === name.toLowerCase()) ?? (name === "time" ? heads.find(head => /^t(ime)?\b/i.test(head)) ?? heads[0] : "");
        const before = this.columns;
        this.columns = new Map();
        for (const name of new Set(wanted)) {
            // what was chosen stays, where the model still has it
            const column = heads.includes(before.get(name)?.from) ? before.get(name) : { from: near(name) ?? "", unit: "" };
            this.columns.set(name, column);
            const select = element("select", { "aria-label": `The column of ${name}`, onchange: event => { column.from = event.target.value; this.later(); } }, ["", ...heads].map(head => element("option", { value: head }, head || "(none)")));
            select.value = column.from;
            const unit = element("input", { size: 4, placeholder: "unit", value: column.unit, "aria-label": `The unit of the column of ${name}, if it is another`, onchange: event => { column.unit = event.target.value.trim(); this.later(); } });
            this.mapped.append(element("label", {}, name, select, unit));
        }
    }

    later() {
        if (!this.live.checked || this.panel.hidden) return;
        clearTimeout(this.timer);
        this.timer = setTimeout(() => (this.panel.hidden ? (this.isNew = true) : this.estimate()), QUIET);
    }

    question() {
        const base = { ask: "observe", ...this.draft.question, estimate: [...this.chosen], method: this.method.value || null, seed: this.value("seed") };
        const { motion } = this.lab.panels;
        if (this.csv == null) {
            const samples = this.value("samples");
            return {
                ...base, noise: this.value("noise"), window: Math.max(2, Math.round(this.value("window") / 100 * (samples - 1))),
                from: { motion: { start: motion.start(), inputs: motion.driven(), duration: this.value("duration"), samples } },
            };
        }
        const columns = {};
        for (const [name, { from, unit }] of this.columns) if (from) columns[name] = { from, unit: unit || null };
        const known = {};
        for (const symbol of this.draft.symbols) {
            if (symbol.kind === "parameter" && !this.chosen.has(symbol.name) && symbol.value != null) known[symbol.name] = symbol.value;
        }
        const { rows } = table(this.csv);
        return {
            ...base, window: Math.max(2, Math.round(this.value("window") / 100 * (rows - 1))), known,
            from: { record: { csv: this.csv, columns, interpolation: null } },
        };
    }

    async estimate() {
        clearTimeout(this.timer);
        if (!this.draft?.sound) return;
        if (this.chosen.size === 0) return this.result.replaceChildren(element("p", { class: "hint" }, "Choose what is to be estimated."));
        this.isNew = false;
        this.abort?.abort();
        const abort = this.abort = new AbortController();
        const { base } = this.draft;
        const begin = performance.now();
        try {
            const found = await this.lab.run("the estimate", signal => ask("answer", this.question(), { signal }), abort);
            if (base === this.draft.base) this.told(found, performance.now() - begin);
        } catch (error) {
            if (error.name !== "AbortError") this.result.replaceChildren(refusal(error));
        }
    }

    /** Speed against accuracy: a point for each estimate since the text changed, by its time and its greatest bound or error. */
    tradeOf(observed) {
        for (const { end, seconds } of observed.observers ?? []) {
            const states = Object.values(end?.states ?? {});
            const size = state => Math.abs(state.recovered) || 1;
            const most = key => Math.max(...states.map(state => (state[key] == null ? NaN : Math.abs(state[key]) / size(state))));
            if (states.length > 0 && seconds > 0) this.trade.push({ seconds, bound: most("bound"), error: most("error") });
        }
        this.trade = this.trade.slice(-40);
        if (this.trade.length < 2) return element("div");
        const curve = (name, key, color) => ({ name, color, dots: true, dash: "1 4", x: this.trade.map(one => one.seconds), y: this.trade.map(one => (one[key] > 0 ? one[key] : NaN)) });
        const curves = [curve("bound", "bound", COLORS[0]), curve("error", "error", COLORS[1])].filter(curve => curve.y.some(Number.isFinite));
        return element("figure", {}, chart({ curves, x: "s of the observer", y: "greatest of all, relative", log: [true, true], label: "Speed against accuracy of the estimates so far" }),
            element("figcaption", {}, `Speed against accuracy: the last ${this.trade.length} estimates, in their order.`));
    }

    told({ observed, page, scene }, took) {
        const parts = [];
        for (const observer of observed.observers ?? []) {
            const { end } = observer;
            const heads = ["", "estimate", "\u00b1 (Cram\u00e9r-Rao)", "true", "error"];
            const rows = Object.entries(end?.states ?? {}).map(([name, state]) => element("tr", {},
                element("td", {}, name), element("td", {}, shown(state.recovered ?? NaN, 6)), element("td", {}, state.bound == null ? "no bound" : shown(state.bound, 2)),
                element("td", {}, state.true == null ? "" : shown(state.true, 6)), element("td", {}, state.error == null ? "" : shown(state.error, 2))));
            parts.push(element("h2", {}, observer.method ?? observer.name ?? "estimate"));
            if (rows.length) parts.push(element("div", { class: "wide" }, element("table", { class: "estimates" }, element("thead", {}, element("tr", {}, heads.map(head => element("th", {}, head)))), element("tbody", {}, rows))));
            const last = observer.updates?.at(-1);
            if (last?.fit) {
                const { fits, chi_square, degrees_of_freedom } = last.fit;
                parts.push(element("p", { class: fits ? "good" : "bad", "data-fits": String(fits) }, `${last.status}; ${fits ? "passes" : "does not pass"} the test of fit: chi-square ${shown(chi_square)} at ${degrees_of_freedom} degrees of freedom`));
            }
            if (observer.seconds != null) parts.push(element("p", { class: "hint", "data-seconds": observer.seconds }, `${shown(observer.seconds, 2)} s of the observer, ${shown(took / 1000, 2)} s in all`));
        }
        this.result.replaceChildren(...parts, this.tradeOf(observed));
        if (page) {
            this.result.append(element("iframe", { src: `/page/${page}`, title: "Estimates, bands, residuals and the test of fit", sandbox: "allow-scripts" }));
        }
        if (scene) this.result.append(element("details", {}, element("summary", {}, "The scene, for 'palmistry observe'"), element("pre", {}, scene)));
    }
}
