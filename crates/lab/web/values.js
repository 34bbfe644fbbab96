// Values of states and parameters that somebody has chosen by a slider. All others are those of the text.

/** Chosen values; one is forgotten when the text gives its symbol another value or range. */
export class Values {
    constructor() {
        this.chosen = new Map();
    }

    set(symbol, value) {
        this.chosen.set(symbol.name, { value, of: Values.of(symbol) });
    }

    /** The value of a symbol; of one that nobody has chosen that of the text, else what stands at a part of its range. */
    get(symbol, part = 0.5) {
        const found = this.chosen.get(symbol.name);
        if (found && found.of === Values.of(symbol)) return found.value;
        return symbol.value ?? symbol.low + (symbol.high - symbol.low) * part;
    }

    has(symbol) {
        return this.chosen.get(symbol.name)?.of === Values.of(symbol);
    }

    clear() {
        this.chosen.clear();
    }

    static of({ value, low, high }) {
        return JSON.stringify([value, low, high]);
    }
}
