// A real headless browser without a network, driven by the DevTools protocol over a pipe: JSON texts
// that end in a zero byte.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export class Browser {
    constructor(chromium, ...options) {
        this.profile = mkdtempSync(join(tmpdir(), "pvt-chromium-"));
        this.requests = [];
        this.errors = [];
        this.waiting = new Map();
        this.next = 1;
        this.loaded = () => {};
        this.process = spawn(chromium, ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
            "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
            "--no-first-run", "--disable-background-networking", "--remote-debugging-pipe",
            "--window-size=1240,1000", ...options, `--user-data-dir=${this.profile}`, "about:blank"],
        { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"], detached: true });
        let rest = "";
        this.process.stdio[4].setEncoding("utf8");
        this.process.stdio[4].on("data", (data) => {
            const texts = (rest + data).split("\0");
            rest = texts.pop();
            texts.forEach((text) => this.receive(JSON.parse(text)));
        });
    }

    receive(message) {
        if (message.id !== undefined) {
            const { resolve, reject } = this.waiting.get(message.id);
            this.waiting.delete(message.id);
            if (message.error) reject(new Error(message.error.message));
            else resolve(message.result);
        } else if (message.method === "Network.requestWillBeSent") {
            this.requests.push(message.params.request.url);
        } else if (message.method === "Page.loadEventFired") {
            this.loaded();
        } else if (message.method === "Runtime.exceptionThrown") {
            this.errors.push(message.params.exceptionDetails.exception?.description ??
                "an exception");
        } else if (message.method === "Runtime.consoleAPICalled" &&
                   ["error", "warning", "assert"].includes(message.params.type)) {
            this.errors.push(message.params.args.map((a) => a.value ?? a.description).join(" "));
        } else if (message.method === "Log.entryAdded" && message.params.entry.level === "error") {
            this.errors.push(message.params.entry.text);
        }
    }

    // With its children, which would go on writing to the profile.
    kill() {
        process.kill(-this.process.pid, "SIGKILL");
    }

    call(method, params = {}, sessionId = undefined) {
        const id = this.next++;
        this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
        return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
    }

    ask(method, params) {
        return this.call(method, params, this.session);
    }

    // Loads the page, offline.
    async open(url) {
        const { targetInfos } = await this.call("Target.getTargets");
        const { targetId } = targetInfos.find((target) => target.type === "page");
        const { sessionId } = await this.call("Target.attachToTarget", { targetId, flatten: true });
        this.session = sessionId;
        for (const domain of ["Page", "Runtime", "Network", "Log"]) await this.ask(`${domain}.enable`);
        await this.ask("Network.emulateNetworkConditions",
            { offline: true, latency: 0, downloadThroughput: -1, uploadThroughput: -1 });
        const done = new Promise((resolve) => { this.loaded = resolve; });
        await this.ask("Page.navigate", { url });
        await done;
    }

    async evaluate(expression) {
        const { result, exceptionDetails } = await this.ask("Runtime.evaluate",
            { expression, awaitPromise: true, returnByValue: true });
        if (exceptionDetails) throw new Error(exceptionDetails.exception.description);
        return result.value;
    }
}

// Runs `examine(browser, expect)`, tells what does not hold, and ends the program with 0 or 1.
export function runInBrowser(browser, examine) {
    const problems = [];
    const expect = (what, holds) => { if (!holds) problems.push(what); };
    const timer = setTimeout(() => {
        console.error("the browser does not answer");
        browser.kill();
        process.exit(1);
    }, 100000);
    const end = () => {
        clearTimeout(timer);
        browser.process.on("exit", () => {
            rmSync(browser.profile, { recursive: true, force: true, maxRetries: 20 });
            problems.forEach((problem) => console.error(`not so: ${problem}`));
            process.exit(problems.length > 0 ? 1 : 0);
        });
        browser.kill();
    };
    examine(browser, expect).catch((error) => problems.push(error.stack)).then(end);
}
