// node engines.mjs CHROMIUM MODULES FILE.glb…: has three.js and Babylon.js load what was written, in a
// real headless browser, and compares what they made of it with what the file says.
import { Browser, runInBrowser } from "./browser.mjs";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const [chromium, modules, ...paths] = process.argv.slice(2);
const template = join(dirname(fileURLToPath(import.meta.url)), "engines.html");
const page = resolve("engines.html");
writeFileSync(page, readFileSync(template, "utf8")
    .replaceAll("MODULES", pathToFileURL(resolve(modules)).href));

// What the file says itself: nodes of the scene, and levels from fine to coarse.
function readFile(path) {
    const bytes = readFileSync(path);
    const json = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
    const describe = (index) => {
        const { name, mesh, extras = {} } = json.nodes[index];
        const { indices, attributes } = json.meshes[mesh].primitives[0];
        const { min, max } = json.accessors[attributes.POSITION];
        return { name, extras, triangles: json.accessors[indices].count / 3, bounds: [...min, ...max],
            ids: json.nodes[index].extensions?.MSFT_lod?.ids };
    };
    const nodes = json.scenes[json.scene].nodes.map(describe);
    const linked = nodes.find((node) => node.ids);
    const levels = linked ? [linked, ...linked.ids.map(describe)] :
        nodes.filter((node) => /_LOD\d+$/.test(node.name));
    return { nodes, levels, isLinked: linked !== undefined, base64: bytes.toString("base64") };
}

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const sortKeys = (value) => (value === null || typeof value !== "object" || Array.isArray(value) ?
    value : Object.fromEntries(Object.keys(value).sort().map((key) => [key, sortKeys(value[key])])));
const pick = (object, ...keys) => keys.map((key) => sortKeys(object[key]));
const sameNodes = (told, wanted, ...keys) => told.length === wanted.length &&
    told.every((node, i) => same(pick(node, ...keys), pick(wanted[i], ...keys)));
// A level is seen from its distance on.
const listSeen = (levels) => levels.slice(1).flatMap((_, i) => [i, i + 1]);

async function checkThree(browser, expect, path, file) {
    const told = await browser.evaluate(`loadInThree("${file.base64}")`);
    const say = (what, holds) =>
        expect(`three.js, ${path}: ${what}: ${JSON.stringify(told)}`, holds);
    const keys = ["name", "triangles", "extras", "bounds"];
    say("the nodes of the scene", sameNodes(told.nodes, file.nodes, ...keys));
    const occluders = told.nodes.filter((node) => node.extras.paravent);
    say("two-sided occluders without transforms", occluders.length > 0 &&
        occluders.every((node) => node.isMesh && node.isTwoSided && node.isBaked));
    say("the levels", sameNodes(told.levels, file.levels, ...keys));
    say("each level is seen from its distance on", same(told.seen, listSeen(file.levels)));
}

async function checkBabylon(browser, expect, path, file) {
    const count = file.isLinked ? file.levels.length : 1;
    const told = await browser.evaluate(`loadInBabylon("${file.base64}", ${count})`);
    const say = (what, holds) =>
        expect(`Babylon.js, ${path}: ${what}: ${JSON.stringify(told)}`, holds);
    const keys = ["name", "triangles", "extras"];
    say("the nodes of the scene", sameNodes(told.meshes, file.nodes, ...keys));
    if (file.isLinked) {
        say("a step a level", same(told.steps, file.levels.map((_, i) => i)));
        say("each level alone", sameNodes(told.levels, file.levels, ...keys));
        const coverages = told.levels[0].extras.MSFT_screencoverage;
        say("a coverage a level, falling", coverages.length === count && coverages.at(-1) === 0 &&
            coverages.every((coverage, i) => i === 0 || coverage < coverages[i - 1]));
        say("levels below the finest", told.levelCount === count - 1);
        say("by its coverage, each level is seen from its distance on",
            same(told.seen, listSeen(file.levels)));
    } else {
        say("no levels", told.steps.length === 0);
    }
}

async function examine(browser, expect) {
    await browser.open(pathToFileURL(page).href);
    for (let tries = 0; tries < 100; ++tries) {
        if (await browser.evaluate("document.body.dataset.ready === 'yes'")) break;
        await new Promise((done) => setTimeout(done, 100));
    }
    for (const path of paths) {
        const file = readFile(path);
        await checkThree(browser, expect, path, file);
        await checkBabylon(browser, expect, path, file);
    }
    const foreign = browser.requests.filter((url) => !/^(file|data|blob):/.test(url));
    expect(`no request is made but ${foreign.join(", ")}`, foreign.length === 0);
    expect(`no error is logged but ${browser.errors.join("; ")}`, browser.errors.length === 0);
}

// Modules of a page that is a file come from files as well.
runInBrowser(new Browser(chromium, "--allow-file-access-from-files"), examine);
