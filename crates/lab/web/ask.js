// Questions to the server, whose answers come as lines of JSON.

const KEY = "palmistry-token";

let own = "";

/** Begins a session: with the token of the address that was opened, with what its code buys, or with what is kept from an earlier page. */
export async function enter() {
    const address = new URL(location.href);
    const [code, given] = ["code", "token"].map(key => address.searchParams.get(key));
    for (const key of ["code", "token"]) address.searchParams.delete(key);
    // they stay out of the history and of links that are copied
    if (code || given) history.replaceState(null, "", address);
    const bought = code && (await ask("enter", { code }).catch(() => null))?.token;
    let failure;
    // an address that a stranger has made up takes nothing away
    for (const candidate of new Set([bought, given, localStorage.getItem(KEY) ?? ""])) {
        if (candidate == null) continue;
        own = candidate;
        try {
            const session = await ask("session", {});
            localStorage.setItem(KEY, own);
            return session;
        } catch (error) {
            failure = error;
        }
    }
    throw failure;
}

/** What answers at once, and waits for nothing. */
const CHEAP = new Set(["draft", "hover", "complete", "format", "models", "model"]);
/** Those that somebody asks by a button, and that may take long. */
const BY_BUTTON = new Set(["values", "drops", "observe", "scene", "page", "import", "fit", "line"]);

/** So many questions of a kind are asked at once: a browser has six ways to a server, and two are for those that wait for nothing. */
class Gate {
    constructor(free) {
        this.free = free;
        this.waiting = [];
    }

    /** A turn: what is returned gives it back. */
    async turn(signal, waits) {
        signal?.throwIfAborted();
        if (this.free > 0) this.free -= 1;
        else {
            waits();
            await new Promise((go, stop) => {
                const entry = () => {
                    signal?.removeEventListener("abort", end);
                    go();
                };
                const end = () => {
                    this.waiting.splice(this.waiting.indexOf(entry), 1);
                    stop(signal.reason);
                };
                this.waiting.push(entry);
                signal?.addEventListener("abort", end, { once: true });
            });
        }
        return () => {
            // the turn goes on to whoever waits longest
            const next = this.waiting.shift();
            if (next) next();
            else this.free += 1;
        };
    }
}

const byButton = new Gate(2);
const live = new Gate(2);

/** What the server says where it has no answer. */
export class NoAnswer extends Error {
    constructor(message, help) {
        super(message);
        this.help = help;
    }
}

/**
 * Asks a question and tells its last line, with the name of a page where there is one; each line before it goes to `line`. Who aborts `signal`
 * ends the work on the server.
 */
export async function ask(path, question, options = {}) {
    if (path !== "answer" || CHEAP.has(question.ask)) return asked(path, question, options);
    const gate = BY_BUTTON.has(question.ask) || question.samples > 0 && question.ask === "rank" ? byButton : live;
    const done = await gate.turn(options.signal, () => options.line?.({ kind: "waiting" }));
    options.line?.({ kind: "begun" });
    try {
        return await asked(path, question, options);
    } finally {
        done();
    }
}

async function asked(path, question, { signal, line }) {
    let response;
    try {
        response = await fetch(`/api/${path}`, {
            method: "POST",
            headers: { "content-type": "application/json", "x-palmistry-token": own },
            body: JSON.stringify(question),
            signal,
        });
    } catch (error) {
        if (error.name === "AbortError") throw error;
        throw new NoAnswer("the lab does not answer: it may have been ended", "start 'palmistry lab' again; the text on this page is kept");
    }
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    let last;
    const take = text => {
        const found = JSON.parse(text);
        if (found.kind === "done" || found.kind === "error") last = found;
        else if (found.kind === "page") last.page = found.page;
        else line?.(found);
    };
    for (;;) {
        const { done, value } = await reader.read();
        if (done) break;
        rest += value;
        const lines = rest.split("\n");
        rest = lines.pop();
        lines.filter(Boolean).forEach(take);
    }
    if (!last) throw new NoAnswer("the answer has ended before its end", "ask again");
    if (last.kind === "error") throw new NoAnswer(last.message, last.help);
    return last;
}

/** An element with attributes and children; texts are never markup. */
export function element(name, attributes = {}, ...children) {
    const found = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (key.startsWith("on")) found.addEventListener(key.slice(2), value);
        else if (value === true) found.setAttribute(key, "");
        else if (value !== false && value != null) found.setAttribute(key, value);
    }
    found.append(...children.flat().filter(child => child != null));
    return found;
}

/** A formula that the server has written; letters where there is none. */
export function formula(mathml, text) {
    const found = element("span");
    if (mathml) found.innerHTML = mathml;
    else found.append(element("code", {}, text));
    return found;
}

/** A number as people read it. */
export function shown(value, digits = 4) {
    if (!Number.isFinite(value)) return String(value);
    if (value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3)) return value.toExponential(digits - 1);
    return String(Number(value.toPrecision(digits)));
}

/** What stands in the way, as a paragraph. */
export function refusal(error) {
    return element("p", { class: "bad", role: "alert" }, error.message, error.help ? ` (${error.help})` : "");
}
