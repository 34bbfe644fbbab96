// The models, papers and scenes that came with the program, and the files of the folder that is served.

import { ask, element, refusal } from "/ask.js";
import { movingScene } from "/scene.js";

/** The names of papers. */
const PAPERS = { examples: "Examples of the book", benchmarks: "Models that people know", moll2002: "Moll 2002: shapes by touch", martinelli2005: "Martinelli 2005: a robot and beacons", hermann1977: "Hermann 1977: nonlinear observability", koteich2015: "Koteich 2015: synchronous machines" };

export class Models {
    constructor(panel, lab) {
        Object.assign(this, { panel, lab });
        this.folder = element("section");
        this.list = element("section");
        this.scene = element("section", { id: "scene" });
        panel.append(this.scene, this.folder, this.list);
    }

    async shown() {
        if (this.lab.session.folder) await this.files();
        if (this.isRead) return;
        try {
            const { papers } = await ask("answer", { ask: "models" });
            this.isRead = true;
            this.list.replaceChildren(...papers.map(paper => this.paper(paper)));
        } catch (error) {
            this.list.replaceChildren(refusal(error));
        }
    }

    paper({ folder, models, scenes }) {
        const count = (number, what) => `${number} ${what}${number === 1 ? "" : "s"}`;
        const card = model => element("button", { title: model.about, "data-file": model.file, onclick: () => this.open(model.file) },
            element("b", {}, model.title ?? model.file), element("small", {}, `${count(model.states, "state")}, ${count(model.outputs, "output")}, ${count(model.claims, "claim")}`), element("small", {}, model.about.slice(0, 120)));
        const scene = one => element("button", { "data-file": one.file, onclick: () => this.play(one) }, element("b", {}, one.title ?? one.file), element("small", {}, "a scene: it is simulated, measured and estimated"));
        return element("details", { open: folder === "benchmarks" }, element("summary", {}, element("b", {}, PAPERS[folder] ?? folder), ` (${models.length})`),
            element("div", { class: "cards" }, models.map(card)), scenes.length ? element("h2", {}, "Scenes") : null, element("div", { class: "cards" }, scenes.map(scene)));
    }

    /** Opens what was chosen last, however long it takes. */
    async open(file) {
        this.opening = file;
        try {
            const { text } = await ask("answer", { ask: "model", model: file });
            if (this.opening !== file) return;
            this.lab.put(text, file);
            this.lab.tab("answers");
        } catch (error) {
            this.lab.notice(error);
        }
    }

    async play(scene) {
        this.scene.replaceChildren(element("h2", {}, scene.title ?? scene.file), element("p", { class: "hint", role: "status" }, "being observed ..."));
        this.scene.scrollIntoView();
        this.playing?.abort();
        const playing = this.playing = new AbortController();
        try {
            const { page, motion, observed, scene: text } = await this.lab.run(scene.title ?? scene.file, (signal, line) => ask("answer", { ask: "scene", scene: scene.file }, { signal, line }), playing);
            this.scene.replaceChildren(element("h2", {}, scene.title ?? scene.file), motion ? movingScene(motion, observed.shape, text) ?? "" : "", element("iframe", { src: `/page/${page}`, title: scene.title ?? scene.file, sandbox: "allow-scripts" }));
        } catch (error) {
            if (playing === this.playing) this.scene.replaceChildren(error.name === "AbortError" ? element("p", {}, "stopped") : refusal(error));
        }
    }

    async files() {
        try {
            const { files } = await ask("files", {});
            this.folder.replaceChildren(element("h2", {}, `Files in ${this.lab.session.folder}`),
                files.length ? element("div", { class: "cards" }, files.map(file => element("button", { "data-file": file, onclick: () => this.read(file) }, file))) : element("p", { class: "hint" }, "none that end with .proof"));
        } catch (error) {
            this.folder.replaceChildren(refusal(error));
        }
    }

    async read(file) {
        this.opening = file;
        try {
            const { text } = await ask("read", { file });
            if (this.opening !== file) return;
            this.lab.put(text, file, text);
            this.lab.tab("answers");
        } catch (error) {
            this.lab.notice(error);
        }
    }
}
