// Questions to the server, whose answers come as lines of JSON.

const KEY = "palmistry-token";

let own = "";

/** Takes the token from the address that was opened, or buys it for the code there; later pages of this browser find it again. */
export async function enter() {
    const address = new URL(location.href);
    const [code, given] = ["code", "token"].map(key => address.searchParams.get(key));
    own = given ?? localStorage.getItem(KEY) ?? "";
    if (code) {
        address.searchParams.delete("code");
        own = (await ask("enter", { code }).catch(() => null))?.token ?? own;
    }
    address.searchParams.delete("token");
    // it stays out of the history and of links that are copied
    if (code || given) history.replaceState(null, "", address);
    localStorage.setItem(KEY, own);
}

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
export async function ask(path, question, { signal, line } = {}) {
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
