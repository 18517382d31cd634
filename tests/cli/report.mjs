// node report.mjs CHROMIUM PAGE.html FOLDER: opens a report in a real headless browser without a
// network. Checks that it asks for nothing, logs no error, shows both meshes, and that the toggles,
// the choice of an occluder and a click on a view change the picture. Leaves pictures in FOLDER.
import { Browser, runInBrowser } from "./browser.mjs";
import { writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [chromium, page, folder] = process.argv.slice(2);
const url = pathToFileURL(resolve(page)).href;

async function examine(browser, expect) {
    const { requests, errors } = browser;
    const ask = (method, params) => browser.ask(method, params);
    const evaluate = (expression) => browser.evaluate(expression);
    await browser.open(url);
    // How many pixels of the model's picture are grey (original), coloured (occluder), blue
    // (over-occlusion) and white, and a sum that changes when it does.
    const look = () => evaluate(`new Promise((done) => requestAnimationFrame(() => {
        const source = document.querySelector("#stage canvas");
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [source.width, source.height];
        const context = canvas.getContext("2d");
        context.drawImage(source, 0, 0);
        const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
        const counts = { grey: 0, coloured: 0, blue: 0, white: 0, sum: 0 };
        for (let i = 0; i < data.length; i += 4) {
            const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
            const spread = Math.max(r, g, b) - Math.min(r, g, b);
            counts.sum = (counts.sum * 31 + r + 256 * g + 65536 * b) % 1000000007;
            if (r === 255 && g === 255 && b === 255) ++counts.white;
            else if (r === 0x1e && g === 0x50 && b === 0xe6) ++counts.blue;
            else if (spread < 24) ++counts.grey;
            else ++counts.coloured;
        }
        done(counts);
    }))`);
    const click = (selector) =>
        evaluate(`document.querySelector(${JSON.stringify(selector)}).click()`);
    const photograph = async (name, isWhole) => {
        const { data } = await ask("Page.captureScreenshot",
            { format: "png", captureBeyondViewport: isWhole });
        writeFileSync(join(folder, name), Buffer.from(data, "base64"));
    };

    expect("the page says that it is ready",
        await evaluate("document.body.dataset.ready") === "yes");
    await evaluate("window.scrollTo(0, 0)");
    const both = await look();
    await photograph("report.png", true);
    expect("both meshes are seen", both.coloured > 2000 && both.grey > 500);
    await click("#show-occluder");
    const original = await look();
    expect("without the occluder only the original is seen",
        original.grey > 2000 && original.coloured < original.grey / 50);
    await click("#show-original");
    const none = await look();
    expect("without both nothing is seen", none.grey + none.coloured + none.blue === 0);
    await click("#show-excess");
    const excess = await look();
    // Smoothed edges are neither quite blue nor quite white.
    expect(`over-occlusion is blue, and nothing else is there: ${JSON.stringify(excess)}`,
        excess.blue > 200 && excess.grey + excess.coloured < excess.blue);
    await photograph("excess.png", false);
    await click("#show-occluder");
    await click("#show-excess");
    const occluder = await look();
    expect("the occluder alone", occluder.coloured > 2000 && occluder.grey < both.grey);
    await click("#show-wireframe");
    expect("the wireframe shows", (await look()).sum !== occluder.sum);
    await click("#show-wireframe");
    expect("and goes", (await look()).sum === occluder.sum);
    await click("#show-original");
    expect("all toggles back: the picture of the start", (await look()).sum === both.sum);

    await evaluate(`{ const choice = document.querySelector("#choice");
        choice.value = "1"; choice.dispatchEvent(new Event("change")); }`);
    expect("another occluder is another picture", (await look()).sum !== both.sum);
    await click("#views button");
    const turned = await look();
    await click("#home");
    expect("a click on a view turns the model", turned.sum !== (await look()).sum);

    const pictures = await evaluate(`(async () => {
        const images = [...document.querySelectorAll("#views img")];
        await Promise.all(images.map((image) => image.decode()));
        return images.map((image) => image.naturalWidth);
    })()`);
    expect("twelve views are pictures", pictures.length === 12 && pictures.every((w) => w > 100));
    expect("one of them is the worst",
        await evaluate("document.querySelectorAll('#views .worst').length") >= 1);
    expect("the plot has its curves",
        await evaluate("document.querySelectorAll('#plot svg .curve').length") >= 3);
    expect("the numbers are there",
        await evaluate("document.querySelectorAll('#numbers tbody tr').length") === 9);
    const making = await evaluate("document.querySelector('#making').textContent");
    expect(`the options that made the occluder: ${making}`, making.includes("resolution"));

    // A drag turns the model.
    const before = await look();
    const mouse = (type, x) => ask("Input.dispatchMouseEvent",
        { type, x, y: 400, button: "left", buttons: 1, clickCount: 1 });
    await evaluate("window.scrollTo(0, 0)");
    await mouse("mousePressed", 400);
    await mouse("mouseMoved", 520);
    await mouse("mouseReleased", 520);
    expect("a drag turns the model", (await look()).sum !== before.sum);
    await photograph("turned.png", false);

    const foreign = requests.filter((asked) => asked !== url && !asked.startsWith("data:"));
    expect(`no request is made but ${foreign.join(", ")}`, foreign.length === 0);
    expect(`no error is logged but ${errors.join("; ")}`, errors.length === 0);
}

runInBrowser(new Browser(chromium), examine);
