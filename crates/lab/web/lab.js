// The page as a whole: the text to the left, what can be said of it to the right.

import { ask, element, enter } from "/ask.js";
import { Answers } from "/answers.js";
import { MapPanel } from "/map.js";
import { Models } from "/models.js";
import { Motion } from "/motion.js";
import { Observe } from "/observe.js";
import { Text } from "/text.js";

/** A text is read when it has not changed for so long, in ms. */
const QUIET = 25;
/** A text in a link, or kept for the next time, is no longer than this. */
const LONGEST = 4 << 20;
const KEPT = "palmistry-text";

const EXAMPLE = `system "A pendulum whose angle is measured"

state phi, omega            # angle and rate
param k = 2                 # gravity over length
angle phi

drift f
  phi'   = omega
  omega' = -k*sin(phi)

output phi

sample
  phi   in [-3, 3]
  omega in [-2, 2]

claim motion: L(f, f, phi) = -k*sin(phi)
claim energy: L(f, omega^2/2 - k*cos(phi)) = 0
claim observable: rank = 2 everywhere
`;

const by = id => document.getElementById(id);

class Lab {
    async begin() {
        this.jobs = new Set();
        this.session = await enter();
        by("version").textContent = this.session.version;
        this.text = new Text(by("editor"), {
            words: this.session.words, question: () => this.question(), changed: () => this.changed(), open: id => this.panels.answers.show(id),
        });
        this.panels = {
            answers: new Answers(by("answers"), this), map: new MapPanel(by("map"), this), motion: new Motion(by("motion"), this),
            observe: new Observe(by("observe"), this), models: new Models(by("models"), this),
        };
        this.tabs();
        this.buttons();
        by("save").hidden = !this.session.folder;
        const { text, file, was, isRestored } = await this.first();
        this.put(text, file, was);
        // what was not saved before a reload is not saved now
        if (isRestored && text !== EXAMPLE) this.placed = { text: was?.replaceAll("\r\n", "\n") };
        if (this.failure) this.notice(this.failure);
        this.text.view.focus();
        document.body.dataset.ready = "true";
    }

    /** The text of the link; else the one that was here before a reload; else the file that the lab was started with; else an example. */
    async first() {
        try {
            const found = await fromLink(location.hash);
            withoutLink();
            if (found) return found;
        } catch (error) {
            this.failure = new Error(`the link holds no text that can be read: ${error.message}`);
        }
        try {
            const kept = JSON.parse(sessionStorage.getItem(KEPT));
            if (typeof kept?.text === "string") return { ...kept, was: kept.was === true ? kept.text : kept.was, isRestored: true };
        } catch { /* a browser that keeps nothing */ }
        const { file } = this.session;
        if (file) {
            try {
                const { text } = await ask("read", { file });
                return { text, file, was: text };
            } catch (error) {
                this.failure = error;
            }
        }
        return { text: EXAMPLE, file: "" };
    }

    question() {
        return { text: this.text.text, file: this.file };
    }

    /** Puts another text here; `file` is where it would stand, and `was` what stands there now. */
    put(text, file = "", was = null) {
        withoutLink();
        const isLost = this.placed && this.text.text !== this.placed.text;
        const before = isLost ? { text: this.written(), file: this.file, was: this.was } : null;
        file = nameOf(file);
        Object.assign(this, { file, was, lineEnd: lineEndOf(text) });
        for (const name of ["map", "motion", "observe"]) this.panels[name].forget();
        by("file-name").textContent = file;
        this.panels.answers.clear();
        this.text.set(text);
        this.placed = { text: this.text.text };
        by("notice").hidden = true;
        // what was written and not saved can be had back
        if (isLost) this.notice(new Error("The text that was here was not saved."), element("button", { onclick: () => this.put(before.text, before.file, before.was) }, "Back to it"));
        this.changed(0);
    }

    /** Keeps the text for a reload of this page. An older one is not kept in its place. */
    keep() {
        const { file, was } = this;
        const text = this.written();
        try {
            sessionStorage.removeItem(KEPT);
            if (text.length <= LONGEST) sessionStorage.setItem(KEPT, JSON.stringify({ text, file, was: was === text ? true : was }));
        } catch { /* it is full, or keeps nothing */ }
    }

    /** The text with the ends of lines that it came with. */
    written() {
        return this.text.text.replaceAll("\n", this.lineEnd);
    }

    changed(wait = QUIET) {
        this.keep();
        // a link is of the text that it was made of
        if (wait > 0) withoutLink();
        // what was asked of another text is no answer to this one
        this.abort?.abort();
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.read(), wait);
        document.body.dataset.told = "false";
    }

    /** Reads the text, and asks what is to be asked of it. What is asked of an older text is ended. */
    async read() {
        this.abort?.abort();
        const { signal } = this.abort = new AbortController();
        // all that is asked is asked of this very text, whatever is typed meanwhile
        const question = this.question();
        try {
            const draft = await ask("answer", { ask: "draft", ...question }, { signal });
            if (signal.aborted) return;
            draft.question = question;
            this.draft = draft;
            by("answers").classList.remove("old");
            this.text.problems(draft.problems);
            const count = draft.problems.length;
            by("state").textContent = count ? `${count} ${count === 1 ? "mistake" : "mistakes"}: line ${draft.problems[0].range.start.line + 1}, ${draft.problems[0].message.split("\n")[0]}` : "no mistakes";
            by("state").className = count ? "bad" : "";
            document.title = draft.title ? `${draft.title}: Palmistry` : "Palmistry: the lab";
            for (const name of ["map", "motion", "observe"]) {
                // pictures of a text before its mistakes are none of this one
                by(name).classList.toggle("old", !draft.sound);
                this.panels[name].update(draft);
            }
            await this.panels.answers.update(draft, signal);
            document.body.dataset.told = "true";
        } catch (error) {
            if (error.name === "AbortError") return;
            by("state").textContent = error.message;
            by("state").className = "bad";
            // what is known is of another text
            this.text.verdicts([]);
            for (const name of ["answers", "map", "motion", "observe"]) by(name).classList.add("old");
        }
    }

    /** Work that nobody asked for by a button: it ends with the text it is about. */
    async quietly(what, outer, work) {
        return this.work(what, outer, work, 700);
    }

    /** Work that somebody asked for. */
    async run(what, work, abort = new AbortController()) {
        return this.work(what, abort.signal, work, 0);
    }

    async work(what, outer, work, wait) {
        const abort = new AbortController();
        const end = () => abort.abort();
        outer.addEventListener("abort", end);
        if (outer.aborted) abort.abort();
        const job = { what, end, done: null };
        // what is over at once is not shown
        const timer = setTimeout(() => { this.jobs.add(job); this.jobsShown(); }, wait);
        try {
            return await work(abort.signal, line => {
                if (line.kind === "waiting" || line.kind === "begun") {
                    job.waits = line.kind === "waiting";
                    this.jobsShown();
                }
                if (line.kind === "progress") {
                    job.done = line.of > 0 ? line.done / line.of : null;
                    this.jobsShown();
                }
            });
        } finally {
            clearTimeout(timer);
            outer.removeEventListener("abort", end);
            this.jobs.delete(job);
            this.jobsShown();
        }
    }

    jobsShown() {
        const jobs = [...this.jobs];
        by("running").hidden = jobs.length === 0;
        if (jobs.length === 0) return;
        by("running-what").textContent = jobs.map(job => (job.waits ? `${job.what} (waits for another)` : job.what)).join("; ");
        const done = jobs[jobs.length - 1].done;
        if (done == null) by("progress").removeAttribute("value");
        else by("progress").value = done;
    }

    notice(error, ...buttons) {
        by("notice").replaceChildren(error.help ? `${error.message} (${error.help}) ` : `${error.message} `, ...buttons);
        by("notice").hidden = false;
    }

    tab(name) {
        for (const tab of by("tabs").children) {
            const isChosen = tab.id === `tab-${name}`;
            tab.setAttribute("aria-selected", isChosen);
            tab.tabIndex = isChosen ? 0 : -1;
            by(tab.id.slice(4)).hidden = !isChosen;
        }
        this.panels[name].shown?.();
    }

    tabs() {
        const all = [...by("tabs").children];
        all.forEach((tab, place) => {
            tab.addEventListener("click", () => this.tab(tab.id.slice(4)));
            tab.addEventListener("keydown", event => {
                const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
                if (!step) return;
                const next = all[(place + step + all.length) % all.length];
                this.tab(next.id.slice(4));
                next.focus();
            });
        });
    }

    buttons() {
        by("stop").addEventListener("click", () => { for (const job of [...this.jobs]) job.end(); });
        by("new").addEventListener("click", () => this.put(EXAMPLE));
        by("open").addEventListener("click", () => by("chosen").click());
        by("chosen").addEventListener("change", event => { this.take([...event.target.files]); event.target.value = ""; });
        by("save").addEventListener("click", () => this.save());
        by("format").addEventListener("click", () => this.format());
        by("link").addEventListener("click", () => this.copy());
        by("export").addEventListener("change", event => { this.exported(event.target.value); event.target.value = ""; });
        addEventListener("hashchange", async () => {
            const found = await fromLink(location.hash).catch(error => this.notice(error));
            if (!found) return;
            withoutLink();
            this.put(found.text, found.file);
        });
        for (const kind of ["dragover", "drop"]) document.body.addEventListener(kind, event => {
            if (!event.dataTransfer?.types.includes("Files")) return;
            event.preventDefault();
            if (kind === "drop") this.take([...event.dataTransfer.files]);
        });
        addEventListener("keydown", event => {
            if ((event.ctrlKey || event.metaKey) && event.key === "s") {
                event.preventDefault();
                this.session.folder ? this.save() : this.exported("proof");
            }
        });
    }

    /** Opens a proof file, a recording, or a file of another program. */
    async take(files) {
        const [first] = files;
        if (!first) return;
        if (/\.(csv|tsv)$/i.test(first.name) && files.length === 1) {
            this.tab("observe");
            return this.panels.observe.taken(first);
        }
        try {
            if (files.reduce((size, file) => size + file.size, 0) > 16 << 20) throw new Error("these files are longer than 16 MiB");
            const texts = Object.fromEntries(await Promise.all(files.map(async file => [file.name, await file.text()])));
            if (/\.proof$/i.test(first.name)) return this.put(texts[first.name], first.name);
            const found = await this.run(`importing ${first.name}`, signal => ask("answer", { ask: "import", files: texts }, { signal }));
            const main = files.find(file => /\.ya?ml$/i.test(file.name)) ?? first;
            this.put(found.proof, main.name.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9_-]+/g, "_") + ".proof");
            if (found.format === "petab") this.panels.observe.problem(texts, found);
            if (found.remarks?.length) this.notice(new Error(found.remarks.join("; ")));
        } catch (error) {
            if (error.name !== "AbortError") this.notice(error);
        }
    }

    async save(elsewhere = false) {
        let { file } = this;
        if (elsewhere || !file || file.startsWith("papers:")) {
            file = prompt("Save as (a path within the folder, ending with .proof)", file.split("/").pop() || "system.proof");
            if (!file) return;
        }
        if (this.isSaving) return;
        this.isSaving = true;
        const { placed } = this;
        try {
            const text = this.written();
            await ask("save", { file, text, was: file === this.file ? this.was : null });
            // another text may have been opened meanwhile
            if (placed !== this.placed) return;
            [this.file, this.was] = [file, text];
            this.placed = { text: this.text.text };
            this.keep();
            by("notice").hidden = true;
            by("file-name").textContent = file;
            by("state").textContent = `saved: ${file}`;
        } catch (error) {
            this.notice(error, element("button", { onclick: () => this.save(true) }, "Save as..."));
        } finally {
            this.isSaving = false;
        }
    }

    async format() {
        try {
            const { text } = this.text;
            const { edits } = await ask("answer", { ask: "format", ...this.question() });
            if (text !== this.text.text) by("state").textContent = "the text has changed meanwhile: it is not brought into its normal form";
            else if (edits) this.text.edit(edits);
            else this.notice(new Error("a text with mistakes has no normal form"));
        } catch (error) {
            this.notice(error);
        }
    }

    async copy() {
        try {
            const address = new URL(location.href);
            address.hash = await toLink(this.question());
            history.replaceState(null, "", address);
            // a page without encryption has no clipboard
            const isCopied = await navigator.clipboard?.writeText(address.href).then(() => true, () => false);
            by("state").textContent = `the link is ${isCopied ? "on the clipboard and " : ""}in the address of this page; whoever runs 'palmistry lab' can open it`;
        } catch (error) {
            this.notice(error);
        }
    }

    async exported(kind) {
        const name = (this.file.split("/").pop() || "system.proof").replace(/\.proof$/, "");
        try {
            if (kind === "proof") download(`${name}.proof`, "text/plain", this.written());
            if (kind === "notebook") download(`${name}.ipynb`, "application/x-ipynb+json", notebook(this.text.text, this.draft?.title ?? name));
            if (kind === "page") {
                const { page } = await this.run("the page", signal => ask("answer", { ask: "page", ...this.question() }, { signal }));
                download(`${name}.html`, "text/html", await (await fetch(`/page/${page}`)).text());
            }
        } catch (error) {
            if (error.name !== "AbortError") this.notice(error);
        }
    }
}

function download(name, type, text) {
    const url = URL.createObjectURL(new Blob([text], { type }));
    element("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A notebook with the text and the questions of this page. */
function notebook(text, title) {
    const cell = (kind, source) => ({
        cell_type: kind, id: [...crypto.getRandomValues(new Uint8Array(4))].map(byte => byte.toString(16).padStart(2, "0")).join(""), metadata: {}, source: source.split(/(?<=\n)/), ...(kind === "code" ? { execution_count: null, outputs: [] } : {}),
    });
    // a string of JSON is one of Python
    const cells = [
        cell("markdown", `# ${title.replace(/[\\`*_{}[\]<>()#+\-.!|]/g, "\\$&")}`),
        cell("code", `import palmistry\n\nsystem = palmistry.System.parse(${JSON.stringify(text)})`),
        cell("code", "system.prove()"), cell("code", "system.rank()"),
    ];
    return JSON.stringify({ cells, metadata: { kernelspec: { display_name: "Python 3", language: "python", name: "python3" } }, nbformat: 4, nbformat_minor: 5 }, null, 1);
}

/** The end that most lines of a text have. */
function lineEndOf(text) {
    const [all, both] = [text.match(/\n/g)?.length ?? 0, text.match(/\r\n/g)?.length ?? 0];
    return 2 * both > all ? "\r\n" : "\n";
}

/** A name under which a text may stand; none where there is no such. */
function nameOf(file) {
    const name = file.replace(/\.proof$/i, ".proof");
    return /^(papers:)?([^/\\\p{Cc}]+\/)*[^/\\\p{Cc}]+\.proof$/u.test(name) && !name.split("/").some(part => [".", ".."].includes(part)) ? name : "";
}

async function through(stream, bytes, most) {
    const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
    const parts = [];
    let size = 0;
    for (;;) {
        const { done, value } = await reader.read();
        if (done) break;
        size += value.length;
        if (size > most) throw new Error("it is longer than 4 MiB");
        parts.push(value);
    }
    return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** A text with its place, compressed, as the fragment of an address. */
async function toLink(question) {
    const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify(question)), LONGEST);
    let letters = "";
    for (const byte of bytes) letters += String.fromCharCode(byte);
    return `text=${btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** Takes the link out of the address: it stays not behind a text that is another one. */
function withoutLink() {
    if (location.hash) history.replaceState(null, "", location.pathname + location.search);
}

async function fromLink(hash) {
    const packed = hash.match(/^#text=([A-Za-z0-9_-]+)$/)?.[1];
    if (!packed) return null;
    const bytes = Uint8Array.from(atob(packed.replaceAll("-", "+").replaceAll("_", "/")), letter => letter.charCodeAt(0));
    const found = JSON.parse(new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes, LONGEST)));
    if (typeof found.text !== "string") throw new Error("it has no text");
    return { text: found.text, file: typeof found.file === "string" ? found.file : "" };
}

new Lab().begin().catch(error => {
    by("notice").textContent = `${error.message}${error.help ? ` (${error.help})` : ""}`;
    by("notice").hidden = false;
});
