// The text: its colours, its mistakes, what can stand at the cursor, what a name is, and the verdicts beside the claims.

import {
    Decoration, EditorState, EditorView, HighlightStyle, StateEffect, StateField, StreamLanguage, WidgetType, acceptCompletion, autocompletion,
    bracketMatching, closeBrackets, defaultKeymap, drawSelection, highlightActiveLine, highlightSelectionMatches, highlightSpecialChars, history,
    historyKeymap, hoverTooltip, keymap, lineNumbers, lintGutter, lintKeymap, search, searchKeymap, setDiagnostics, syntaxHighlighting, tags,
} from "/editor.js";
import { ask, element } from "/ask.js";

/** The colours of the language, by the very words that the reader reads by. */
function language(words) {
    const [entries, reserved, functions, special] = ["entries", "reserved", "functions", "special"].map(key => new Set(words[key]));
    return StreamLanguage.define({
        name: "palmistry",
        startState: () => ({}),
        token(stream) {
            if (stream.eatSpace()) return null;
            if (stream.match(/^#.*/)) return "comment";
            if (stream.match(/^"[^"]*"?/)) return "string";
            if (stream.match(/^\d+(\.\d+)?([eE][+-]?\d+)?/)) return "number";
            const begin = stream.string.slice(0, stream.pos).trim() === "";
            if (stream.match(/^[A-Za-z_][A-Za-z0-9_.]*/)) {
                const word = stream.current();
                if (begin && entries.has(word)) return "keyword";
                if (functions.has(word) && stream.match(/^\s*\(/, false)) return "function";
                if (reserved.has(word) || special.has(word)) return "keyword";
                return "name";
            }
            stream.next();
            return "operator";
        },
        languageData: { commentTokens: { line: "#" }, closeBrackets: { brackets: ["(", "[", "{", '"'] } },
        tokenTable: { name: tags.variableName, function: tags.function(tags.variableName) },
    });
}

const colours = HighlightStyle.define([
    { tag: tags.comment, color: "var(--soft)", fontStyle: "italic" },
    { tag: tags.keyword, color: "var(--accent)", fontWeight: "600" },
    { tag: tags.string, color: "var(--good)" },
    { tag: tags.number, color: "var(--first)" },
    { tag: tags.function(tags.variableName), color: "var(--second)" },
]);

const looks = EditorView.theme({
    "&": { backgroundColor: "var(--paper)", color: "var(--ink)" },
    ".cm-content": { fontFamily: "ui-monospace, monospace", fontSize: "14px", caretColor: "var(--ink)" },
    ".cm-cursor": { borderLeftColor: "var(--ink)" },
    ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--soft)", borderRight: "1px solid var(--line)" },
    ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "color-mix(in srgb, var(--accent) 7%, transparent)" },
    "&.cm-focused .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "color-mix(in srgb, var(--accent) 25%, transparent) !important" },
    ".cm-tooltip, .cm-panels": { backgroundColor: "var(--raised)", color: "var(--ink)", border: "1px solid var(--line)" },
    ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--paper)" },
    ".cm-told": { padding: ".3rem .6rem", maxWidth: "34rem", whiteSpace: "pre-wrap" },
    ".cm-diagnostic": { whiteSpace: "pre-wrap" },
});

class Verdict extends WidgetType {
    constructor(id, word, ok, told, open) {
        super();
        Object.assign(this, { id, word, ok, told, open });
    }
    eq(other) {
        return other.id === this.id && other.word === this.word && other.ok === this.ok && other.told === this.told;
    }
    toDOM() {
        return element("button", {
            class: "verdict", "data-w": this.word, "data-ok": String(this.ok), title: this.told, "aria-label": `${this.id}: ${this.word}`,
            onclick: () => this.open(this.id),
        }, this.word);
    }
    ignoreEvent() {
        return true;
    }
}

const setVerdicts = StateEffect.define();
const verdicts = StateField.define({
    create: () => Decoration.none,
    update(found, transaction) {
        found = found.map(transaction.changes);
        for (const effect of transaction.effects) if (effect.is(setVerdicts)) found = effect.value;
        return found;
    },
    provide: field => EditorView.decorations.from(field),
});

/** The editor; `changed` is called when somebody has changed the text. */
export class Text {
    constructor(parent, { words, question, changed, open }) {
        this.question = question;
        this.open = open;
        const nonce = document.querySelector("meta[name=nonce]").content;
        this.extensions = [
            EditorView.cspNonce.of(nonce), lineNumbers(), lintGutter(), highlightSpecialChars(), history(), drawSelection(), highlightActiveLine(),
            bracketMatching(), closeBrackets(), highlightSelectionMatches(), search({ top: true }), EditorState.tabSize.of(4),
            language(words), syntaxHighlighting(colours), looks, verdicts,
            autocompletion({ override: [context => this.complete(context)], activateOnTypingDelay: 60 }),
            hoverTooltip((view, at) => this.hover(at), { hoverTime: 250 }),
            keymap.of([{ key: "Tab", run: acceptCompletion }, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...lintKeymap]),
            EditorView.contentAttributes.of({ "aria-label": "The text of the system" }),
            EditorView.updateListener.of(update => update.docChanged && changed()),
        ];
        this.view = new EditorView({ parent, state: this.fresh("") });
    }

    fresh(doc) {
        return EditorState.create({ doc, extensions: this.extensions });
    }

    get text() {
        return this.view.state.doc.toString();
    }

    /** Puts another text in the place of this one. It has a history of its own: what is undone leads not back into another file. */
    set(text) {
        this.view.setState(this.fresh(text));
    }

    /** The place of a position of the language server. */
    at({ line, character }) {
        const { doc } = this.view.state;
        if (line >= doc.lines) return doc.length;
        const found = doc.line(line + 1);
        return Math.min(found.from + character, found.to);
    }

    position(at) {
        const line = this.view.state.doc.lineAt(at);
        return { line: line.number - 1, character: at - line.from };
    }

    async complete(context) {
        const word = context.matchBefore(/[A-Za-z_][A-Za-z0-9_.]*/);
        if (!word && !context.explicit) return null;
        const kinds = { 3: "function", 6: "variable", 9: "namespace", 11: "type", 14: "keyword", 21: "constant" };
        const abort = new AbortController();
        context.addEventListener("abort", () => abort.abort());
        const found = await ask("answer", { ask: "complete", ...this.question(), position: this.position(context.pos) }, { signal: abort.signal }).catch(() => null);
        if (!found) return null;
        // what stands there already is not to be accepted once more
        const options = found.items.filter(item => item.label !== word?.text).map(item => ({ label: item.label, detail: item.detail, type: kinds[item.kind] }));
        return { from: word ? word.from : context.pos, options, validFor: /^[A-Za-z0-9_]*$/ };
    }

    async hover(at) {
        const found = await ask("answer", { ask: "hover", ...this.question(), position: this.position(at) }).catch(() => null);
        if (!found?.hover) return null;
        const { contents, range } = found.hover;
        // Markdown of one kind: words, and a part of the file
        const told = contents.value.replace(/```palmistry\n|\n```/g, "").replace(/\*\*(.*?)\*\*/g, "$1").replace(/`/g, "");
        return { pos: this.at(range.start), end: this.at(range.end), above: true, create: () => ({ dom: element("div", { class: "cm-told" }, told) }) };
    }

    /** Shows mistakes, as diagnostics of the language server. */
    problems(found) {
        const diagnostics = found.map(problem => ({
            from: this.at(problem.range.start), to: this.at(problem.range.end), severity: "error", message: problem.message,
        }));
        this.view.dispatch(setDiagnostics(this.view.state, diagnostics));
    }

    /** Shows verdicts behind the first lines of claims: `{ range, id, word, ok, told }`. */
    verdicts(claims) {
        const widgets = claims.map(claim => {
            const line = this.view.state.doc.lineAt(this.at(claim.range.start));
            return Decoration.widget({ widget: new Verdict(claim.id, claim.word, claim.ok, claim.told, this.open), side: 1 }).range(line.to);
        });
        this.view.dispatch({ effects: setVerdicts.of(Decoration.set(widgets, true)) });
    }

    /** Goes to a range. */
    show(range) {
        const [from, to] = [this.at(range.start), this.at(range.end)];
        this.view.dispatch({ selection: { anchor: from, head: to }, effects: EditorView.scrollIntoView(from, { y: "center" }) });
        this.view.focus();
    }

    /** Makes edits of the language server. */
    edit(edits) {
        const changes = edits.map(edit => ({ from: this.at(edit.range.start), to: this.at(edit.range.end), insert: edit.newText }));
        this.view.dispatch({ changes });
    }
}
