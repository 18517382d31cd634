// Fills the page from the data that paravent has put into it.
import { Stage } from "./scene.js";

const find = (id) => document.getElementById(id);
const read = (id) => JSON.parse(find(id).textContent);

function create(tag, text, parent, className) {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    if (className) element.className = className;
    parent.append(element);
    return element;
}

const percent = (fraction, digits = 2) => `${(100 * fraction).toFixed(digits)} %`;
const count = (number) => number.toLocaleString("en-US");
const short = (number) => (number === 0 ? "0" : Number(number.toPrecision(3)).toString());

// As many digits as the standard error leaves, and never a full hundred that is none.
function withError(fraction, error) {
    if (error === 0) return fraction === 1 || fraction === 0 ? `${100 * fraction} %` : percent(fraction);
    const digits = Math.min(4, Math.max(0, -Math.floor(Math.log10(100 * error))));
    return `${(100 * fraction).toFixed(digits)} ± ${(100 * error).toFixed(digits)} %`;
}

const MEASURES = [
    ["triangles", (o) => [o.triangles, count(o.triangles)], 0],
    ["precision, uniform quads", (o, e) => [o.uniform.precision, withError(o.uniform.precision, e[0])], 1],
    ["recall, uniform quads", (o, e) => [o.uniform.recall, withError(o.uniform.recall, e[1])], 1],
    ["precision, small quads", (o, e) => [o.small.precision, withError(o.small.precision, e[2])], 1],
    ["recall, small quads", (o, e) => [o.small.recall, withError(o.small.recall, e[3])], 1],
    ["coverage", (o, e) => [o.coverage, withError(o.coverage, e[4])], 1],
    ["worst view's recall", (o) => [o.worst_view.recall, percent(o.worst_view.recall, 1)], 1],
    ["over-occluded area", (o) => [o.over_area, short(o.over_area)], -1],
    ["over-occlusion's thickness", (o) => [o.over_thickness, short(o.over_thickness)], -1],
];

function fillNumbers(scores, extra) {
    const head = create("tr", undefined, create("thead", undefined, find("numbers")));
    create("th", "", head);
    extra.names.forEach((name) => create("th", name, head));
    const body = create("tbody", undefined, find("numbers"));
    for (const [label, get, sense] of MEASURES) {
        const row = create("tr", undefined, body);
        create("td", label, row);
        const cells = scores.occluders.map((o, i) => get(o, extra.errors[i]));
        const best = Math.max(...cells.map(([value]) => sense * value));
        for (const [value, text] of cells) {
            const isBest = sense !== 0 && cells.length > 1 && sense * value === best;
            create("td", text, row, isBest ? "best" : undefined);
        }
    }
    find("sampling").textContent = `${count(scores.views)} random views, ${count(scores.quads)} ` +
        `quads of each kind a view, ${scores.pixels} pixels, seed ${scores.seed}. ± one standard ` +
        "error of the sampling. Areas and lengths are in the model's units.";
}

function fillViews(scores, extra, chosen, stage) {
    find("views").replaceChildren();
    extra.views.forEach((view, k) => {
        const score = scores.occluders[chosen].per_view[view];
        const isWorst = view === extra.worst[chosen];
        const button = create("button", undefined, find("views"), isWorst ? "worst" : undefined);
        button.type = "button";
        const image = create("img", undefined, button);
        image.src = extra.pictures[chosen][k];
        image.alt = `view ${view}`;
        create("span", `${isWorst ? "worst: " : ""}recall ${percent(score.uniform.recall, 1)}`,
            button);
        button.addEventListener("click", () => {
            stage?.look(score.direction);
            find("stage").scrollIntoView({ behavior: "smooth", block: "nearest" });
        });
    });
}

// What `paravent generate` leaves with an occluder's node.
function findMaking(text) {
    try {
        const nodes = JSON.parse(text).nodes ?? [];
        return nodes.map((node) => node.extras?.paravent).find((made) => made !== undefined);
    } catch {
        return undefined;
    }
}

function describe(value) {
    if (typeof value === "object") return JSON.stringify(value);
    return String(typeof value === "number" ? Number(value.toPrecision(6)) : value);
}

function fillMaking(extra) {
    extra.names.forEach((name, i) => {
        create("h3", name, find("making"));
        const made = extra.gltf[i] === null ? undefined : findMaking(extra.gltf[i]);
        if (made === undefined || made === null || typeof made !== "object") {
            create("p", "The file does not tell.", find("making"));
            return;
        }
        const list = create("dl", undefined, find("making"));
        for (const [key, value] of Object.entries(made)) {
            create("dt", key.replaceAll("_", " "), list);
            create("dd", describe(value), list);
        }
    });
}

function openStage(extra) {
    try {
        return new Stage(find("stage"), find("mesh-0").textContent,
            extra.names.map((_, i) => find(`mesh-${i + 1}`).textContent));
    } catch (error) {
        find("failure").textContent = `The model cannot be shown in 3-D here: ${error.message}`;
        find("failure").hidden = false;
        return undefined;
    }
}

function connect(scores, extra, stage) {
    const toggles = { original: "show-original", occluder: "show-occluder",
        wireframe: "show-wireframe", excess: "show-excess" };
    for (const [layer, id] of Object.entries(toggles)) {
        find(id).addEventListener("change", () => {
            if (!stage) return;
            stage.shown[layer] = find(id).checked;
            stage.draw();
        });
    }
    extra.names.forEach((name, i) => {
        create("option", name, find("choice")).value = String(i);
    });
    find("choice").addEventListener("change", () => {
        const chosen = Number(find("choice").value);
        fillViews(scores, extra, chosen, stage);
        if (!stage) return;
        stage.chosen = chosen;
        stage.draw();
    });
    find("home").addEventListener("click", () => stage?.look([-0.6, -0.35, -0.72]));
}

const scores = read("scores"), extra = read("extra");
document.title = `paravent: ${extra.original}`;
find("title").textContent = `Occluders of ${extra.original}`;
find("subtitle").textContent = `${count(scores.original.triangles)} triangles; evaluated by ` +
    `paravent ${scores.version}`;
fillNumbers(scores, extra);
fillMaking(extra);
find("plot").append(find("plot-source").content);
const stage = openStage(extra);
fillViews(scores, extra, 0, stage);
connect(scores, extra, stage);
document.body.dataset.ready = stage ? "yes" : "no";
