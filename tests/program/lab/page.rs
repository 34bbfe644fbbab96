//! Five uses of the page, and what has to hold of it for everybody: keys alone, a narrow window, a dark one, names for who listens.

use super::Lab;
use super::browser::Browser;
use crate::common::{folder, write};
use std::path::Path;

const PENDULUM: &str = "system \"A pendulum\"\nstate phi, omega\nparam k = 2\nangle phi\ndrift f\n  phi' = omega\n  omega' = -k*sin(phi)\noutput phi\nsample phi in [-3, 3] omega in [-2, 2]\nclaim motion: L(f, f, phi) = -k*sin(phi)\nclaim seen: rank = 2 everywhere\n";

/// The verdicts beside the text, in its order.
const VERDICTS: &str =
    "[...document.querySelectorAll('.cm-content .verdict')].map(one => one.textContent).join(' ')";
const TOLD: &str = "document.body.dataset.told === 'true'";

fn model(name: &str) -> String {
    format!("[data-file=\"papers:{name}\"]")
}

fn open(browser: &mut Browser, name: &str) {
    browser.click("#tab-models");
    browser.until(&format!("document.querySelector('{}')", model(name)));
    browser.click(&model(name));
    browser.until(&format!("document.getElementById('file-name').textContent === 'papers:{name}' && {TOLD}"));
}

/// A pendulum from nothing: a mistake at its place while one types, verdicts beside the claims when it is whole, another verdict when a sign
/// changes, and only that one anew; completion and what a name is.
#[test]
fn a_pendulum_from_nothing() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    assert_eq!(browser.text("location.search"), "", "the token has left the address");
    browser.write("system \"A pendulum\"\nstate phi, omega\ndrift f\n  phi' = omga\n");
    browser.until("document.querySelector('#state.bad')");
    assert!(browser.text("document.getElementById('state').textContent").contains("line 4"));
    browser.until("document.querySelector('.cm-lintRange-error')?.textContent === 'omga'");
    browser.picture("a_mistake");
    browser.write(PENDULUM);
    browser.until(TOLD);
    assert_eq!(browser.text(VERDICTS), "proved proved");
    let table = browser.text("document.querySelector('.unknowns tbody').innerText");
    assert_eq!(table.matches("locally observable").count(), 2, "{table}");
    assert!(browser.text("document.querySelector('#answers-system').innerText").contains("sin"));
    browser.picture("a_pendulum");
    // a sign: the other claim is not decided again
    let asked = "window.asked = []; const own = window.fetch; window.fetch = (path, init) => { window.asked.push(JSON.parse(init.body)); return own(path, init); }";
    browser.value(asked);
    browser.write(&PENDULUM.replace("phi) = -k*sin(phi)\nclaim seen", "phi) = k*sin(phi)\nclaim seen"));
    let took = browser.until(&format!("{VERDICTS} === 'refuted proved'"));
    println!("from the edit to its verdict: {} ms", took.as_millis());
    let decided =
        "window.asked.filter(one => one.ask === 'claims').map(one => one.only.join(' ')).join('; ')";
    assert_eq!(browser.text(decided), "motion");
    assert_eq!(browser.value("window.asked.filter(one => one.ask === 'rank').length"), 0);
    browser.click(".cm-content .verdict");
    browser.until("document.querySelector('details[data-id=motion][open]')");
    let told = browser.text("document.querySelector('details[data-id=motion] pre').textContent");
    assert!(told.contains("refuted at") && told.contains("left") && told.contains("right"), "{told}");
    browser.picture("a_refutation");
    // what can stand at the cursor
    browser.value("document.querySelector('.cm-content').focus()");
    browser.key("End", 35, 2);
    browser.type_text("claim more: L(f, ome");
    browser.until(
        "[...document.querySelectorAll('.cm-completionLabel')].some(one => one.textContent === 'omega')",
    );
    browser.picture("completions");
    // a list that has only just opened takes no keys, lest it takes those of somebody who types on
    std::thread::sleep(std::time::Duration::from_millis(300));
    browser.key("Enter", 13, 0);
    browser.until("document.querySelector('.cm-content').innerText.includes('L(f, omega')");
    assert_eq!(browser.faults, Vec::<String>::new());
}

/// A robot and a beacon: an unobservable direction and two starts with the same outputs; with a second beacon a map with a pointer, and sliders.
#[test]
fn a_robot_whose_second_beacon_appears() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    open(&mut browser, "martinelli2005/one_beacon.proof");
    let unknowns = browser.text("document.querySelector('#answers-unknowns').innerText");
    assert!(unknowns.contains("unobservable") && unknowns.contains("Unobservable directions"), "{unknowns}");
    browser.click("#tab-motion");
    browser.until("document.getElementById('motion').innerText.includes('The outputs of both differ by')");
    let differ =
        browser.text("document.getElementById('motion').innerText.match(/differ by ([0-9.e+-]+)/)[1]");
    assert!(differ.parse::<f64>().is_ok_and(|differ| differ < 1e-9), "{differ}");
    browser.picture("two_starts");
    open(&mut browser, "martinelli2005/two_beacons.proof");
    assert!(browser.text(VERDICTS).starts_with("proved"));
    browser.click("#tab-map");
    browser.until("document.querySelector('#map canvas').dataset.done === 'true'");
    // from light to dark: the two beacons lie on the axis, where the heading is told badly
    let light = |browser: &mut Browser, row: f64| {
        let pixel = format!(
            "[...document.querySelector('#map canvas').getContext('2d').getImageData(10, Math.floor(96*{row}), 1, 1).data].slice(0, 3).reduce((a, b) => a + b)"
        );
        browser.value(&pixel).as_f64().expect("a number")
    };
    let (far, near) = (light(&mut browser, 0.1), light(&mut browser, 0.5));
    assert!(far > near + 50.0, "{far} {near}");
    browser.value("document.querySelector('#map canvas').focus()");
    browser.key("ArrowUp", 38, 0);
    browser.until("/x = .*y = .*standard deviation/.test(document.querySelector('#map .read').textContent)");
    browser.until("document.querySelector('#map .read').textContent.includes('rank 3 of 3 (certified)')");
    browser.picture("two_beacons");
    // a slider draws anew
    browser.value("window.drawn = 0; const put = CanvasRenderingContext2D.prototype.putImageData; CanvasRenderingContext2D.prototype.putImageData = function (...all) { window.drawn++; return put.apply(this, all); }");
    browser.value("(() => { const slider = document.querySelector('#map input[type=range][aria-label=b]'); slider.value = slider.max; slider.dispatchEvent(new Event('input')); })()");
    browser.until("window.drawn >= 4");
    // towards the singular set
    browser.value("(() => { const zero = document.querySelector('#map input[placeholder]'); zero.value = 'y'; const moving = document.querySelector('#map select[aria-label=\"The coordinate that moves\"]'); moving.value = 'y'; })()");
    browser.value(
        "[...document.querySelectorAll('#map button')].find(one => one.textContent === 'Draw').click()",
    );
    browser.until("document.querySelector('#map svg polyline')");
    assert_eq!(browser.faults, Vec::<String>::new());
}

/// A model of another program is imported, its global answer asked for, stopped, and kept in a link that another page opens.
#[test]
fn a_model_is_imported_stopped_and_linked() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    browser.choose("#chosen", &[&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/imports/covid.jl")]);
    browser.until(&format!("document.getElementById('file-name').textContent === 'covid.proof' && {TOLD}"));
    browser.until("document.querySelector('.unknowns')");
    browser.picture("an_import");
    // a problem of parameter estimation with its measurements
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/petab/Boehm_JProteomeRes2014");
    let files: Vec<_> =
        std::fs::read_dir(folder).expect("it is there").map(|entry| entry.expect("a file").path()).collect();
    let files: Vec<&Path> = files
        .iter()
        .map(|file| file.as_path())
        .filter(|file| file.extension().is_some_and(|end| end != "md"))
        .collect();
    browser.choose("#chosen", &files);
    browser.until(&format!(
        "document.getElementById('file-name').textContent === 'Boehm_JProteomeRes2014.proof' && {TOLD}"
    ));
    browser.click("#tab-observe");
    browser.value("[...document.querySelectorAll('#observe button')].find(one => one.textContent === 'Fit the imported problem').click()");
    browser.until("document.querySelector('#observe iframe[title^=\"The fit\"]')");
    browser.picture("a_problem");
    open(&mut browser, "benchmarks/pharm.proof");
    browser.value("[...document.querySelectorAll('#answers-more button')].find(one => one.textContent === 'Globally?').click()");
    browser.until("!document.getElementById('running').hidden");
    browser.click("#stop");
    browser.until(
        "document.getElementById('answers-more').innerText.includes('stopped; what was found until then')",
    );
    browser.until("document.getElementById('running').hidden");
    browser.write(PENDULUM);
    browser.until(TOLD);
    browser.value("[...document.querySelectorAll('#answers-more button')].find(one => one.textContent === 'Singular set').click()");
    browser.until("document.querySelector('[data-asked=\"Singular set\"] pre').textContent.includes('generic rank 2 of 2')");
    browser.click("#link");
    browser.until("location.hash.startsWith('#text=')");
    let (link, text) =
        (browser.text("location.href"), browser.text("document.querySelector('.cm-content').innerText"));
    assert!(!link.contains(&lab.token));
    browser.page();
    browser.go(&link);
    assert_eq!(browser.text("document.querySelector('.cm-content').innerText"), text);
    assert_eq!(browser.text(VERDICTS), "proved proved");
    // what is taken home: the text, a page, a notebook
    browser.value("window.kept = {}; URL.createObjectURL = blob => { blob.text().then(text => { window.kept[blob.type] = text; }); return '#'; }; HTMLAnchorElement.prototype.click = () => {}");
    for (kind, file) in
        [("proof", "text/plain"), ("page", "text/html"), ("notebook", "application/x-ipynb+json")]
    {
        browser.value(&format!("(() => {{ const list = document.getElementById('export'); list.value = '{kind}'; list.dispatchEvent(new Event('change')); }})()"));
        browser.until(&format!("window.kept['{file}']"));
    }
    assert_eq!(browser.text("window.kept['text/plain']"), PENDULUM);
    assert!(browser.text("window.kept['text/html']").contains("A pendulum"));
    let cells = "JSON.parse(window.kept['application/x-ipynb+json']).cells.map(cell => cell.source.join('')).join('\\n')";
    assert!(browser.text(cells).contains("palmistry.System.parse(\"system"));
    // what a name is
    browser.value("window.at = (() => { const line = [...document.querySelectorAll('.cm-line')].find(one => one.textContent.includes(\"omega' =\")); const box = line.getBoundingClientRect(); return [box.left + 30, box.top + box.height/2]; })()");
    let [x, y] = ["window.at[0]", "window.at[1]"].map(|at| browser.value(at));
    browser.send("Input.dispatchMouseEvent", serde_json::json!({ "type": "mouseMoved", "x": x, "y": y }));
    browser.until("document.querySelector('.cm-told')?.textContent.includes('state omega')");
    // a link that holds nothing, and one that would fill the memory
    for hash in ["#text=AAAA", "#text=____"] {
        browser.page();
        browser.go(&format!("http://{}/{hash}", lab.host));
        assert!(
            browser
                .text("document.getElementById('notice').textContent")
                .contains("no text that can be read")
        );
    }
}

/// A body between its palms, flat ones and circular ones, moves, and its outline is there.
#[test]
fn a_body_moves_between_its_palms() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    browser.click("#tab-models");
    let circular = model("moll2002/scenes/circular_palms.toml");
    browser.until(&format!("document.querySelector('{circular}')"));
    browser.click(&circular);
    browser.until("document.querySelector('#scene iframe')");
    assert_eq!(browser.value("document.querySelectorAll('#scene svg .palm').length"), 2);
    std::thread::sleep(std::time::Duration::from_secs(5));
    browser.picture("circular_palms");
    let scene = model("moll2002/scenes/general.toml");
    browser.value("document.querySelector('#scene iframe').remove()");
    browser.click(&scene);
    browser.until("document.querySelector('#scene iframe')");
    let trail = "document.querySelector('#scene .trail').getAttribute('points').length";
    browser.value("(() => { const time = document.querySelector('#scene input[type=range]'); time.value = 20; time.dispatchEvent(new Event('input')); })()");
    let early = browser.value(trail).as_u64();
    browser.value("(() => { const time = document.querySelector('#scene input[type=range]'); time.value = time.max; time.dispatchEvent(new Event('input')); })()");
    assert!(browser.value(trail).as_u64() > early);
    browser.value("document.querySelector('#scene').scrollIntoView()");
    browser.picture("a_body");
    // its page has its own script, and no way to this one
    let page = browser.text("document.querySelector('#scene iframe').src");
    assert_eq!(
        browser
            .value(&format!("fetch('{page}').then(found => found.headers.get('content-security-policy'))")),
        "sandbox allow-scripts"
    );
    assert_eq!(browser.faults, Vec::<String>::new());
}

/// A recording is dropped: its columns are found by their names, and the length of the pendulum with a deviation.
#[test]
fn a_recording_is_dropped() {
    let Some(mut browser) = Browser::begin() else { return };
    let (lab, folder) = (Lab::open(), folder());
    browser.go(&lab.url);
    let rows: Vec<String> = (0..200)
        .map(|i| format!("{},{}", f64::from(i) * 0.05, 0.3 * (2.0 * f64::from(i) * 0.05).cos()))
        .collect();
    let file = write(&folder, "log.csv", format!("Time,X\n{}\n", rows.join("\n")));
    browser.write("system \"A spring\"\nstate x, v\nparam k = 3\ndrift f\n  x' = v\n  v' = -k*x\noutput x\nsample x in [-1, 1] v in [-1, 1]\n");
    browser.until(TOLD);
    browser.click("#tab-observe");
    browser.click("#observe input[type=checkbox][value=k]");
    browser.choose("#observe input[type=file]", &[&file]);
    browser.until("document.querySelector('#observe table.estimates')?.innerText.includes('k') && document.querySelector('#observe iframe')");
    let k = browser.text("[...document.querySelectorAll('#observe table.estimates tr')].find(row => row.cells[0].textContent === 'k').cells[1].textContent");
    assert!((k.parse::<f64>().expect("a number") - 4.0).abs() < 1e-4, "{k}");
    assert!(browser.text("document.querySelector('#observe').innerText").contains("log.csv: 200 rows"));
    browser.picture("a_recording");
    // simulated instead, noise and window are sliders: the bound grows with the noise
    browser.value("[...document.querySelectorAll('#observe button')].find(one => one.textContent === 'Simulate instead').click()");
    let bound = |browser: &mut Browser, noise: &str| -> f64 {
        browser.value("document.querySelector('#observe table.estimates')?.remove()");
        browser.value(&format!("(() => {{ const slider = document.querySelector('#observe input[aria-label=noise]'); slider.value = {noise}; slider.dispatchEvent(new Event('input')); }})()"));
        browser.until("document.querySelector('#observe table.estimates')");
        browser.text("[...document.querySelectorAll('#observe table.estimates tr')].find(row => row.cells[0].textContent === 'k').cells[2].textContent").parse().expect("a number")
    };
    let (small, large) = (bound(&mut browser, "-4"), bound(&mut browser, "-2"));
    assert!((50.0..200.0).contains(&(large / small)), "{small} {large}");
    browser.picture("a_simulation");
    assert_eq!(browser.faults, Vec::<String>::new());
}

/// In each tab, by day and by night, at 400 pixels: nothing is wider than the window.
#[test]
fn a_narrow_window_by_night() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.dark();
    browser.size(400, 900);
    browser.go(&lab.url);
    open(&mut browser, "martinelli2005/two_beacons.proof");
    for tab in ["answers", "map", "motion", "observe", "models"] {
        browser.click(&format!("#tab-{tab}"));
        browser.until(&format!("!document.getElementById('{tab}').hidden"));
        std::thread::sleep(std::time::Duration::from_millis(500));
        let wide = browser.value("document.documentElement.scrollWidth");
        assert!(wide.as_u64().is_some_and(|wide| wide <= 400), "{tab}: {wide}");
        browser.picture(&format!("narrow_{tab}"));
    }
    let paper = browser.text("getComputedStyle(document.body).backgroundColor");
    assert_eq!(paper, "rgb(20, 23, 28)");
    assert_eq!(browser.text("getComputedStyle(document.querySelector('.cm-editor')).backgroundColor"), paper);
}

/// Keys alone: out of the text, through the tabs, to a button and its answer; and everything that can be used has a name.
#[test]
fn keys_alone_and_names_for_who_listens() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    assert_eq!(browser.text("document.activeElement.className").split(' ').next(), Some("cm-content"));
    let focus = "document.activeElement.id || document.activeElement.textContent";
    for _ in 0..10 {
        browser.key("Tab", 9, 0);
        if browser.text(focus) == "tab-answers" {
            break;
        }
    }
    assert_eq!(browser.text(focus), "tab-answers");
    browser.key("ArrowRight", 39, 0);
    assert_eq!(browser.text(focus), "tab-map");
    assert_eq!(browser.value("document.getElementById('map').hidden"), false);
    browser.key("ArrowLeft", 37, 0);
    for _ in 0..10 {
        browser.key("Tab", 9, 0);
        if browser.text(focus) == "Singular set" {
            break;
        }
    }
    browser.key("Enter", 13, 0);
    browser.until(
        "document.querySelector('[data-asked=\"Singular set\"] pre').textContent.includes('generic rank')",
    );
    open(&mut browser, "martinelli2005/two_beacons.proof");
    for tab in ["answers", "map", "motion", "observe", "models"] {
        browser.click(&format!("#tab-{tab}"));
        std::thread::sleep(std::time::Duration::from_millis(500));
        let nodes = browser.send("Accessibility.getFullAXTree", serde_json::json!({}))["nodes"].clone();
        let roles = [
            "button",
            "textbox",
            "slider",
            "combobox",
            "tab",
            "checkbox",
            "link",
            "image",
            "spinbutton",
            "img",
        ];
        for node in nodes.as_array().expect("nodes") {
            let (role, name) = (node["role"]["value"].as_str(), node["name"]["value"].as_str());
            let is_used = role.is_some_and(|role| roles.contains(&role)) && node["ignored"] == false;
            assert!(!is_used || name.is_some_and(|name| !name.trim().is_empty()), "{tab}: {node}");
        }
    }
}

/// What stands in a stranger's text is letters: in titles, in claims, in mistakes, in what a name is, on the page of an answer.
#[test]
fn a_strangers_text_is_no_markup() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    let markup = "<img src=x onerror=window.hacked=1><script>window.hacked=1</script>";
    let text = format!(
        "system \"{markup}\" cite \"{markup}\"\nstate x\nparam k = 2\ndrift f x' = -k*x\noutput x\nclaim 1: L(f, x) = k*x \"{markup}\"\nset \"{markup}\": x = 0\nmap \"{markup}\": x in [0, 1], k in [1, 2]\n"
    );
    browser.write(&text);
    browser.until(TOLD);
    browser.until(&format!("{VERDICTS} === 'refuted'"));
    for tab in ["map", "motion", "observe", "models", "answers"] {
        browser.click(&format!("#tab-{tab}"));
        std::thread::sleep(std::time::Duration::from_millis(400));
    }
    browser.click(".cm-content .verdict");
    browser.write(&format!("{text}claim 2: {markup} = 1\n"));
    browser.until("document.querySelector('#state.bad')");
    assert_eq!(
        browser.value(
            "window.hacked === undefined && !document.querySelector('img') && document.scripts.length === 1"
        ),
        true
    );
    // even where it would be markup, the page runs nothing but its own
    let refused = browser.value("(() => { const script = document.createElement('script'); script.textContent = 'window.hacked = 1'; document.body.append(script); return window.hacked === undefined; })()");
    assert_eq!(refused, true);
}

/// A file has a history of its own, an edit survives a reload after a link was copied, a file of the folder can be saved after a reload, and who
/// was there first is not written over.
#[test]
fn nothing_is_lost_between_files_and_reloads() {
    let Some(mut browser) = Browser::begin() else { return };
    let folder = folder();
    let [one, other] = ["one", "other"].map(|name| format!("system \"{name}\"\r\nstate x\r\n"));
    for (name, text) in [("one.proof", &one), ("other.proof", &other)] {
        write(&folder, name, text);
    }
    let lab = Lab::begin(&["--port", "0", folder.path().to_str().unwrap()]);
    browser.go(&lab.url);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("it is there");
    let open = |browser: &mut Browser, name: &str| {
        browser.click("#tab-models");
        browser.until(&format!("document.querySelector('[data-file=\"{name}\"]')"));
        browser.click(&format!("[data-file=\"{name}\"]"));
        browser.until(&format!("document.getElementById('file-name').textContent === '{name}' && {TOLD}"));
    };
    open(&mut browser, "one.proof");
    open(&mut browser, "other.proof");
    browser.value("document.querySelector('.cm-content').focus()");
    browser.key("z", 90, 2);
    browser.click("#save");
    browser.until("document.getElementById('state').textContent.startsWith('saved')");
    assert_eq!((read("one.proof"), read("other.proof")), (one.clone(), other.clone()));
    browser.click("#link");
    browser.until("location.hash.startsWith('#text=')");
    browser.write("system \"mine\"\nstate y\n");
    assert_eq!(browser.text("location.hash"), "");
    browser.until(TOLD);
    browser.send("Page.reload", serde_json::json!({}));
    browser.until(&format!("document.querySelector('.cm-content')?.innerText.includes('mine') && {TOLD}"));
    browser.value(
        "window.asked = []; window.prompt = told => { window.asked.push(told); return 'third.proof'; }",
    );
    browser.click("#save");
    browser.until("document.getElementById('state').textContent === 'saved: other.proof'");
    assert_eq!(read("other.proof"), "system \"mine\"\r\nstate y\r\n");
    // what was saved can be saved again after a reload
    browser.send("Page.reload", serde_json::json!({}));
    browser.until(&format!("document.querySelector('.cm-content')?.innerText.includes('mine') && {TOLD}"));
    browser.write("system \"mine\"\nstate y # again\n");
    browser.click("#save");
    browser.until("document.getElementById('state').textContent === 'saved: other.proof'");
    assert_eq!(read("other.proof"), "system \"mine\"\r\nstate y # again\r\n");
    // what was not saved can be had back
    browser.write("system \"precious\"\nstate y\n");
    browser.click("#new");
    browser.until("document.getElementById('notice')?.textContent.includes('was not saved')");
    browser.click("#notice button");
    browser.until("document.querySelector('.cm-content').innerText.includes('precious')");
    browser.write("system \"mine\"\nstate y\n");
    browser.value("window.prompt = () => 'third.proof'");
    // somebody else writes meanwhile
    write(&folder, "other.proof", &other);
    browser.click("#save");
    browser
        .until("document.getElementById('notice')?.textContent.includes('was changed since it was opened')");
    browser.click("#notice button");
    browser.until("document.getElementById('state').textContent === 'saved: third.proof'");
    assert_eq!(
        (read("other.proof"), read("third.proof")),
        (other, "system \"mine\"\r\nstate y\r\n".to_owned())
    );
}

/// Answers are to the text that stands there: values that are edited reach every panel, what is of another system goes, a claim that was stopped
/// says so, and Enter ends a line.
#[test]
fn answers_are_to_the_text_that_stands_there() {
    let Some(mut browser) = Browser::begin() else { return };
    let lab = Lab::open();
    browser.go(&lab.url);
    for tab in ["map", "motion", "observe", "answers"] {
        browser.click(&format!("#tab-{tab}"));
    }
    browser.write(&PENDULUM.replace("k = 2", "k = 5"));
    browser.until(TOLD);
    let slider = |browser: &mut Browser, panel: &str| {
        browser.text(&format!("document.querySelector('#{panel} input[type=range][aria-label=k]').value"))
    };
    assert_eq!([slider(&mut browser, "map"), slider(&mut browser, "motion")], ["5", "5"]);
    // one that somebody has moved stays, until the text says something else
    browser.value("(() => { const slider = document.querySelector('#motion input[type=range][aria-label=k]'); slider.value = 6; slider.dispatchEvent(new Event('input')); })()");
    browser.write(&PENDULUM.replace("k = 2", "k = 5").replace("output phi", "output phi, omega"));
    browser.until(TOLD);
    assert_eq!([slider(&mut browser, "map"), slider(&mut browser, "motion")], ["5", "6"]);
    browser.write(&PENDULUM.replace("k = 2", "k = 7"));
    browser.until(TOLD);
    assert_eq!(slider(&mut browser, "motion"), "7");
    // estimates of the pendulum are none of another system
    browser.click("#tab-observe");
    browser.until("document.querySelector('#observe table.estimates')?.innerText.includes('omega')");
    browser.write("system \"Other\"\nstate z\ndrift f z' = -z\noutput z\n");
    browser.until(TOLD);
    assert_eq!(browser.value("document.querySelector('#observe').innerText.includes('omega')"), false);
    browser.click("#tab-answers");
    // answers that come late come from a server that is slow
    browser.value("window.own = window.fetch; window.slow = () => true; window.fetch = async (path, init) => { const found = await window.own(path, init); if (window.slow(JSON.parse(init.body).ask)) await new Promise(go => setTimeout(go, 1500)); init.signal?.throwIfAborted(); return found; }");
    browser.value("window.slow = ask => ask === 'claims'");
    browser.write(PENDULUM);
    browser.until("!document.getElementById('running').hidden && document.getElementById('running-what').textContent.includes('deciding')");
    browser.click("#stop");
    browser.until(&format!("{VERDICTS} === 'stopped stopped'"));
    browser.value("window.slow = () => false");
    browser.value("[...document.querySelectorAll('#claims-summary button')].find(one => one.textContent === 'Go on').click()");
    browser.until(&format!("{VERDICTS} === 'proved proved'"));
    // the table of the old text is no table of the new one
    browser.value("window.slow = ask => ask === 'rank'");
    browser.write(&PENDULUM.replace("omega' = -k*sin(phi)", "omega' = 0"));
    browser.until(&format!("{VERDICTS}.startsWith('refuted')"));
    assert_eq!(browser.value("document.querySelector('#answers-unknowns').classList.contains('old')"), true);
    browser.until("!document.querySelector('#answers-unknowns').classList.contains('old')");
    browser.value("window.slow = () => false");
    browser.write("");
    browser.type_text("state x, v");
    std::thread::sleep(std::time::Duration::from_millis(600));
    browser.key("Enter", 13, 0);
    browser.type_text("output x");
    assert!(browser.text("document.querySelector('.cm-content').innerText").starts_with("state x, v\n"));
    // questions that are taken back leave their turns to others, whatever the order
    let turns = "import('/ask.js').then(async ({ ask }) => { \
        const slow = () => { const abort = new AbortController(); const done = ask('answer', { ask: 'claims', text: '', only: [] }, { signal: abort.signal }).catch(error => error.name); return { abort, done }; }; \
        window.slow = ask => ask === 'claims'; const all = [slow(), slow(), slow(), slow(), slow()]; all[0].abort.abort(); await all[0].done; await new Promise(go => setTimeout(go, 50)); \
        all[2].abort.abort(); all[3].abort.abort(); all[1].abort.abort(); window.slow = () => false; const last = await Promise.race([all[4].done, new Promise(go => setTimeout(go, 10000, 'lost'))]); \
        return last.message ?? last.kind ?? last; })";
    let found = browser.text(turns);
    assert_ne!(found, "lost");
    // an address that a stranger has made up
    browser.page();
    browser.go(&format!("http://{}/?token=evil", lab.host));
    assert_eq!(browser.text("document.getElementById('notice').textContent"), "");
}
