// What is claimed and whether it holds; what is observable and identifiable; the system as mathematics.

import { ask, element, formula, refusal } from "/ask.js";

/** The words that stand beside a claim while it is decided. */
const PENDING = "...";
const STOPPED = "stopped";
/** In ms. */
const SOON = 30;

/** The panel of the answers. Verdicts are kept by what they depend on, so that what did not change is not decided again. */
export class Answers {
    constructor(panel, lab) {
        this.lab = lab;
        this.known = new Map();
        this.asked = new Set();
        this.blocks = Object.fromEntries(["unknowns", "more", "claims", "system"].map(name => [name, element("section", { id: `answers-${name}` })]));
        panel.append(...Object.values(this.blocks));
        this.results = element("div");
        const dear = [
            ["Globally?", "each unknown globally, locally or not identifiable, with the number of solutions", { ask: "values" }],
            ["Identifiable functions", "generators of all functions of the unknowns that have one value", { ask: "values", functions: true }],
            ["Singular set", "the rank-deficient states, with a proof that there are no others", { ask: "drops" }],
            ["At 1000 states", "the certified rank at 1000 sampled states", { ask: "rank", samples: 1000 }],
        ];
        const buttons = dear.map(([name, title, question]) => element("button", { title, onclick: () => this.more(name, question) }, name));
        this.blocks.more.append(element("div", { class: "row", role: "group", "aria-label": "Further questions" }, buttons), this.results);
        this.clear();
    }

    clear() {
        clearTimeout(this.soon);
        this.soon = null;
        this.base = null;
        this.unknowns = null;
        this.tableOf = null;
        this.isStopped = false;
        this.results.replaceChildren();
        for (const name of ["claims", "unknowns", "system"]) this.blocks[name].replaceChildren();
        this.mathematicsShown = null;
        this.blocks.more.hidden = true;
    }

    /** Takes in what a text says. What is wrong with it leaves the last answers where they are, and says so. */
    async update(draft, signal) {
        this.draft = draft;
        this.isStopped = false;
        if (draft.mathematics != null) this.mathematics(draft);
        this.listed();
        if (!draft.sound) return;
        const missing = draft.claims.filter(claim => !this.known.has(claim.key));
        const isNew = draft.base !== this.base;
        if (isNew) {
            // what was asked of another system is ended
            for (const abort of this.asked) abort.abort();
            this.results.replaceChildren();
            this.unknowns = null;
        }
        this.base = draft.base;
        this.dimmed();
        const work = [];
        if (missing.length > 0) work.push(this.decide(draft, missing, signal));
        if (this.tableOf !== draft.base) work.push(this.rank(draft, signal));
        await Promise.all(work);
    }

    /** An answer to another text is no answer to this one. */
    dimmed() {
        this.blocks.unknowns.classList.toggle("old", !this.draft.sound || this.tableOf !== this.draft.base);
        this.results.classList.toggle("old", !this.draft.sound);
    }

    async decide(draft, claims, signal) {
        const keys = new Map(claims.map(claim => [claim.id, claim.key]));
        const take = found => {
            if (found.kind !== "claim") return;
            this.known.set(keys.get(found.claim.id), found.claim);
            this.listedSoon();
        };
        const question = { ask: "claims", ...draft.question, only: [...keys.keys()] };
        try {
            await this.lab.quietly(`deciding ${keys.size} claims`, signal, signal => ask("answer", question, { signal, line: take }));
        } catch (error) {
            if (error.name !== "AbortError" || signal.aborted) throw error;
            // somebody has pressed Stop
            this.isStopped = true;
            this.listed();
        }
        this.listed();
        // thousands of texts later the first ones are forgotten
        while (this.known.size > 20000) this.known.delete(this.known.keys().next().value);
    }

    async rank(draft, signal) {
        const { unknowns } = this.blocks;
        this.blocks.more.hidden = !draft.outputs?.length;
        if (!draft.outputs?.length) {
            this.tableOf = draft.base;
            unknowns.replaceChildren();
            return;
        }
        try {
            this.unknowns = await this.lab.quietly("the rank", signal, signal => ask("answer", { ask: "rank", samples: 0, ...draft.question }, { signal }));
            this.tableOf = draft.base;
            this.table();
        } catch (error) {
            if (error.name === "AbortError" && signal.aborted) throw error;
            const isStopped = error.name === "AbortError";
            this.tableOf = isStopped ? null : draft.base;
            unknowns.classList.remove("old");
            const again = isStopped ? element("button", { onclick: () => this.lab.read() }, "Go on") : null;
            unknowns.replaceChildren(...[element("h2", {}, "Observable and identifiable"), refusal(isStopped ? new Error("stopped before the rank was known") : error), again].filter(Boolean));
        }
    }

    /** The verdict of a claim of the text as it stands, if it is known. */
    of(claim) {
        return this.draft.sound ? this.known.get(claim.key) : null;
    }

    /** A hundred verdicts that come at once are shown at once. */
    listedSoon() {
        this.soon ??= setTimeout(() => this.listed(), SOON);
    }

    /** Claims with their verdicts, beside the text and in a list. */
    listed() {
        clearTimeout(this.soon);
        this.soon = null;
        const { draft } = this;
        const pending = this.isStopped ? STOPPED : PENDING;
        const found = draft.claims.map(claim => ({ claim, outcome: this.of(claim) }));
        this.lab.text.verdicts(draft.sound ? found.map(({ claim, outcome }) => ({
            range: claim.range, id: claim.id, word: outcome?.verdict ?? pending, ok: outcome?.ok ?? true, told: outcome?.text ?? "not decided yet",
        })) : []);
        this.dimmed();
        if (draft.claims.length === 0) {
            this.blocks.claims.replaceChildren();
            return;
        }
        if (!draft.sound) {
            this.blocks.claims.replaceChildren(element("h2", {}, "Claims"), element("p", { class: "hint" }, "Nothing is decided of a text with mistakes."));
            return;
        }
        const counts = {};
        let unexpected = 0;
        for (const { outcome } of found) {
            if (!outcome) continue;
            counts[outcome.verdict] = (counts[outcome.verdict] ?? 0) + 1;
            unexpected += outcome.ok ? 0 : 1;
        }
        const words = Object.entries(counts).map(([word, count]) => `${count} ${word}`).join(", ");
        const left = found.filter(({ outcome }) => !outcome).length;
        const summary = element("p", { id: "claims-summary" }, `${draft.claims.length} ${draft.claims.length === 1 ? "claim" : "claims"}: ${words || "none decided"}`,
            left ? `; ${left} ${this.isStopped ? "left, since this was stopped " : "being decided"}` : "; ",
            left && this.isStopped ? element("button", { onclick: () => this.lab.read() }, "Go on") : "", left ? "" : element("b", { class: unexpected ? "bad" : "good" }, `${unexpected} not as expected`));
        const opened = new Set([...this.blocks.claims.querySelectorAll("details[open]")].map(details => details.dataset.id));
        const items = found.map(({ claim, outcome }) => this.item(claim, outcome, opened.has(claim.id), pending));
        this.blocks.claims.replaceChildren(element("h2", {}, "Claims"), summary, element("ul", { class: "claims" }, items));
    }

    item(claim, outcome, open, pending) {
        const word = outcome?.verdict ?? pending;
        const head = element("summary", {}, element("span", { class: "verdict", "data-w": word, "data-ok": String(outcome?.ok ?? true) }, word), " ", claim.id);
        const details = element("details", { "data-id": claim.id }, head);
        // of hundreds of claims one or two are looked into
        const fill = () => {
            if (!details.open || details.childElementCount > 1) return;
            const error = outcome?.error_bound && outcome.error_bound !== "0" ? `; error probability below ${outcome.error_bound}` : "";
            const body = outcome ? [element("div", { class: "formula" }, formula(outcome.mathml, outcome.statement)), element("pre", {}, outcome.text)] : [];
            if (outcome?.engine) body.push(element("p", { class: "hint" }, `by ${outcome.engine}${error}`));
            details.append(...body, element("button", { onclick: () => this.lab.text.show(claim.range) }, "Show in the text"));
        };
        details.addEventListener("toggle", fill);
        details.open = open;
        fill();
        return element("li", { "data-w": word }, details);
    }

    /** Opens a claim in the list. */
    show(id) {
        this.lab.tab("answers");
        for (const details of this.blocks.claims.querySelectorAll("details")) {
            if (details.dataset.id !== id) continue;
            details.open = true;
            details.dispatchEvent(new Event("toggle"));
            details.scrollIntoView({ block: "center" });
            details.querySelector("summary").focus();
        }
    }

    table() {
        const { rank, unobservable, text } = this.unknowns;
        const branches = rank.branches ?? [rank];
        const parts = [element("h2", {}, "Observable and identifiable")];
        branches.forEach((branch, place) => {
            if (branch.conditions?.length) parts.push(element("p", {}, `where ${branch.conditions.join(", ")}`));
            const globally = this.globally && this.globally.base === this.base ? this.globally.unknowns : null;
            const rows = (branch.unknowns ?? []).map(one => {
                const symbol = this.draft.symbols?.find(symbol => symbol.name === one.name);
                const isBad = /unobservable|non-identifiable/.test(one.verdict);
                return element("tr", {},
                    element("td", {}, formula(symbol?.mathml, one.name)), element("td", {}, one.kind),
                    element("td", { class: isBad ? "bad" : one.verdict === "undecided" ? "" : "good" }, one.verdict),
                    globally ? element("td", {}, globally.get(one.name) ?? "") : null);
            });
            const heads = ["unknown", "is a", "and is", ...(globally ? ["values for given outputs"] : [])];
            parts.push(element("div", { class: "wide" }, element("table", { class: "unknowns" },
                element("thead", {}, element("tr", {}, heads.map(head => element("th", {}, head)))), element("tbody", {}, rows))));
            const { fields = [], fields_missing, functions = [], functions_missing, for_all_parameters: forAll } = unobservable[place] ?? {};
            const held = Object.entries(branch.fixed_at_the_files_values ?? {}).map(([name, value]) => `${name} = ${value}`).join(", ");
            if (held) parts.push(element("p", { class: "hint", id: "held" }, `at the values in the file: ${held}`));
            if (fields.length || fields_missing) {
                parts.push(element("h2", {}, "Unobservable directions"));
                parts.push(element("p", { class: "hint" }, `Along such a field no output and none of its Lie derivatives changes (proved, generically, ${forAll ? "for all parameter values" : "at the values in the file"}).`));
                for (const field of fields) {
                    const components = field.components.flatMap((part, place) => [place ? ",\u2003" : "", formula(part.mathml[0], part.of), "\u2032 = ", formula(part.mathml[1], part.text)]);
                    parts.push(element("p", { class: "formula wide", title: field.text }, components));
                }
                if (fields_missing) parts.push(element("p", {}, `${fields_missing} more, of which no field of low degree was found.`));
            }
            if (functions.length || functions_missing) {
                parts.push(element("h2", {}, "Identifiable combinations (generically)"));
                for (const found of functions) parts.push(element("p", { class: "formula wide" }, formula(found.mathml, found.text)));
                if (functions_missing) parts.push(element("p", {}, `${functions_missing} more, which were not found in low degree.`));
            }
        });
        parts.push(element("details", {}, element("summary", {}, "In words"), element("pre", {}, text)));
        this.blocks.unknowns.replaceChildren(...parts);
        this.dimmed();
    }

    async more(name, question) {
        const { base, draft } = this;
        const button = [...this.blocks.more.querySelectorAll("button")].find(button => button.textContent === name);
        button.disabled = true;
        const abort = new AbortController();
        this.asked.add(abort);
        const output = element("pre");
        const state = element("p", { class: "hint", role: "status" }, "searching ...");
        const block = element("section", { "data-asked": name }, element("h2", {}, name), state, output);
        this.results.prepend(block);
        const take = found => {
            if (found.kind === "so-far") {
                state.textContent = "so far; the search goes on ...";
                output.textContent = found.text;
            }
        };
        try {
            const answer = await this.lab.run(name, (signal, line) => ask("answer", { ...question, ...draft.question }, { signal, line: found => { line(found); take(found); } }), abort);
            state.remove();
            output.textContent = answer.text;
            if (answer.global && base === this.base) {
                const word = one => one.verdict ?? "";
                this.globally = { base, unknowns: new Map(answer.global.unknowns.map(one => [one.name, word(one)])) };
                this.table();
            }
        } catch (error) {
            state.replaceWith(error.name === "AbortError" ? element("p", { class: "hint" }, "stopped; what was found until then stands here") : refusal(error));
        } finally {
            button.disabled = false;
            this.asked.delete(abort);
        }
    }

    mathematics(draft) {
        const shown = JSON.stringify([draft.title, draft.cite, draft.mathematics]);
        if (shown === this.mathematicsShown) return;
        this.mathematicsShown = shown;
        const found = element("div");
        found.innerHTML = draft.mathematics;
        this.blocks.system.replaceChildren(element("h2", {}, "The system"), element("p", {}, element("b", {}, draft.title ?? ""), draft.cite ? ` (${draft.cite})` : ""),
            element("div", { class: "wide" }, found));
    }
}
