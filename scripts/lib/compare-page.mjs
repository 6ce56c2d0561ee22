// Compares pictures of the page with stills of the program, and uses the page as a visitor does:
// node compare-page.mjs PAGE_FOLDER PROGRAM SONG, in an X server. Chromium uses the system's OpenGL driver: its own
// software renderer crashes while it compiles most scenes.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [folder, program, tagged] = process.argv.slice(2);
const SCENES = ["orb", "metaballs", "speakers"];
/// A show with a fade and a melt at two of the moments.
const SHOW = "at start orb\nat 0:15 metaballs fade over 4 s\nat 0:38 orb melt over 4 s\nat 1:00 speakers cut\n";
/// Seconds before a moment at which the show prepares its scenes.
const AHEAD = 5;
const MOMENTS = [3, 9.5, 16.2, 23, 31.7, 40.1, 48.9, 57.3, 66, 75.4];
const SIZE = [192, 108];
/// A pixel differs if a channel differs by more than this, of 255.
const DIFFERENCE = 16;
const DIFFERING_MAX = 0.005;
const KINDS = { html: "text/html", css: "text/css", js: "text/javascript", wasm: "application/wasm", png: "image/png" };

/// Draws the frames of all moments in the page, and returns the fraction of differing pixels of each.
const COMPARE = async (scene, show, moments, [width, height], difference, ahead) => {
    if (!document.querySelector("script")) {
        const script = Object.assign(document.createElement("script"), { src: "/mariana_page.js" });
        await new Promise((resolve) => { script.onload = resolve; document.head.append(script); });
        await wasm_bindgen({ module_or_path: "/mariana_page_bg.wasm" });
    }
    const page = wasm_bindgen;
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false });
    const studio = new page.Studio(gl);
    const rest = () => new Promise((resolve) => setTimeout(resolve, 20));
    studio.set_edge_samples(16);
    const bytes = await (await fetch("/song")).arrayBuffer();
    const sound = await new OfflineAudioContext(2, 1, 48000).decodeAudioData(bytes);
    const [left, right] = [sound.getChannelData(0), sound.getChannelData(1)];
    studio.begin_sound(48000, false);
    studio.push_song(left, right);
    studio.finish_song();
    if (show) studio.follow_show(show, [], []);
    else studio.load(scene, page.scene_text(scene), false);
    while (!show && !studio.receive_scene(false)) await rest();
    let heard = 0;
    const found = [];
    for (const moment of moments) {
        const until = Math.ceil((moment + 1) * 48000);
        studio.push_samples(left.subarray(heard, until), right.subarray(heard, until));
        heard = until;
        for (; studio.is_loading(moment - ahead); await rest()) studio.draw(moment - ahead, width, height);
        studio.draw(moment, width, height);
        const own = new Uint8Array(4 * width * height);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, own);
        const bitmap = await createImageBitmap(await (await fetch(`/still/${scene}/${moment}.png`)).blob());
        const paper = new OffscreenCanvas(width, height).getContext("2d");
        paper.drawImage(bitmap, 0, 0);
        const still = paper.getImageData(0, 0, width, height).data;
        let differing = 0;
        for (let y = 0; y < height; y++) {
            for (let x = 0; x < width; x++) {
                const [a, b] = [4 * ((height - 1 - y) * width + x), 4 * (y * width + x)];
                differing += [0, 1, 2].some((c) => Math.abs(own[a + c] - still[b + c]) > difference);
            }
        }
        found.push(differing / (width * height));
    }
    return found;
};

const stills = mkdtempSync(join(tmpdir(), "mariana-page-"));
// A page cannot read the loudness in a song's tags, which the program follows.
const song = join(stills, "song.ogg");
execFileSync("ffmpeg", ["-v", "error", "-i", tagged, "-map_metadata", "-1", "-map_metadata:s", "-1", "-c", "copy", song]);
const show = join(stills, "of.show");
writeFileSync(show, SHOW);
const still = (scene, moment) => {
    const file = join(stills, `${scene}-${moment}.png`);
    const shows = scene === "show" ? ["--show", show] : ["--scene", scene];
    execFileSync(program, ["still", song, ...shows, "--at", String(moment), "--size", SIZE.join("x"), "-o", file]);
    return file;
};
const server = createServer((request, answer) => {
    const path = request.url.split(/[?#]/)[0];
    const [, kind, scene, moment] = path.split("/");
    try {
        const asked = join(folder, path === "/" ? "index.html" : path);
        const file = kind === "song" ? song : kind === "still" ? still(scene, parseFloat(moment)) : asked;
        const bytes = readFileSync(file);
        answer.writeHead(200, { "content-type": KINDS[file.split(".").pop()] ?? "application/octet-stream" }).end(bytes);
    } catch {
        answer.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const address = `http://127.0.0.1:${server.address().port}/`;

// The DevTools protocol over two pipes: messages end with a zero byte.
const names = ["chromium", "chromium-browser", "google-chrome"];
const browser = names.find((name) => { try { return execFileSync("which", [name]); } catch { return false; } });
if (!browser) throw new Error("Chromium not found: install the package chromium");
const flags = ["--no-sandbox", "--no-first-run", "--use-angle=gl", "--ignore-gpu-blocklist", "--disable-gpu-sandbox", "--disable-gpu-watchdog",
    "--disable-dev-shm-usage", "--autoplay-policy=no-user-gesture-required", "--window-size=320,240", "--remote-debugging-pipe", `--user-data-dir=${join(stills, "profile")}`];
const process_ = spawn(browser, [...flags, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const ended = new Promise((resolve) => process_.once("exit", resolve));
const answers = new Map();
let rest = "";
process_.stdio[4].setEncoding("utf8").on("data", (text) => {
    const messages = (rest + text).split("\0");
    rest = messages.pop();
    for (const { id, result, error } of messages.map(JSON.parse)) {
        answers.get(id)?.(error ? Promise.reject(new Error(error.message)) : result);
        answers.delete(id);
    }
});
let count = 0;
let session;
const ask = (method, params = {}) => {
    const answer = new Promise((resolve) => answers.set(++count, resolve));
    process_.stdio[3].write(`${JSON.stringify({ id: count, method, params, sessionId: session })}\0`);
    return Promise.race([answer, ended.then(() => Promise.reject(new Error("Chromium has ended")))]);
};
const evaluate = async (expression) => {
    const { result, exceptionDetails } = await ask("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.exception?.value ?? exceptionDetails.text);
    return result.value;
};
const until = async (what, expression) => {
    for (let tries = 0; !(await evaluate(expression)); tries++) {
        if (tries > 1200) throw new Error(`waited in vain for: ${what}`);
        await new Promise((resolve) => setTimeout(resolve, 100));
    }
};

try {
    const { targetId } = await ask("Target.createTarget", { url: "about:blank" });
    session = (await ask("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    await ask("Page.navigate", { url: `${address}style.css` });
    await until("the server", `location.href === ${JSON.stringify(`${address}style.css`)}`);
    let worst = 0;
    for (const scene of [...SCENES, "show"]) {
        const given = [scene, scene === "show" ? SHOW : "", MOMENTS, SIZE, DIFFERENCE, AHEAD];
        const found = await evaluate(`(${COMPARE})(${given.map((of) => JSON.stringify(of))})`);
        console.log(`${scene}: % of the pixels that differ: ${found.map((part) => (100 * part).toFixed(2)).join(" ")}`);
        worst = Math.max(worst, ...found);
    }
    if (!(worst <= DIFFERING_MAX)) throw new Error(`a picture differs in ${(100 * worst).toFixed(2)} % of its pixels`);

    await ask("Page.navigate", { url: address });
    const shown = (id) => `(document.getElementById("${id}")?.textContent ?? "")`;
    const plays = `document.getElementById("welcome").hidden && /^0:(0[1-9]|[1-5])/.test(${shown("time")})`;
    await until("the first scene", `document.getElementById("scene")?.value === "orb"`);
    await evaluate(`document.getElementById("demo").click()`);
    await until("the demo", plays);
    await evaluate(`document.getElementById("play").click()`);
    await until("the pause", `${shown("play")} === "Play"`);
    const key = (name) => evaluate(`dispatchEvent(new KeyboardEvent("keydown", { key: "${name}" }))`);
    const follows = `document.getElementById("follow").ariaPressed === "true"`;
    await until("the show", follows);
    const scene = `document.getElementById("scene").value`;
    const before = await evaluate(scene);
    await key("n");
    await until("the next scene", `${scene} !== ${JSON.stringify(before)} && !(${follows})`);
    await evaluate(`{ const text = document.getElementById("text"); text.value = "sphere(p, "; text.dispatchEvent(new Event("input")); }`);
    await until("the mistake", `${shown("mistakes")}.includes("sphere")`);
    await evaluate(`{ const text = document.getElementById("text"); text.value = "param size = 1 in 0 .. 2\\nsphere(p, size)"; text.dispatchEvent(new Event("input")); }`);
    await until("the mended text", `${shown("mistakes")} === ""`);
    await key("l");
    await until("the link", `location.hash.length > 20`);
    const link = await evaluate("location.href");
    await ask("Page.navigate", { url: "about:blank" });
    await ask("Page.navigate", { url: link });
    await until("the linked text", `(document.getElementById("text")?.value ?? "").includes("sphere(p, size)")`);
    const alone = join(stills, "alone.html");
    for (const [flags, state] of [[["--scene", "metaballs"], `${scene} === "metaballs"`], [["--show", show], follows]]) {
        execFileSync(program, ["page", song, ...flags, "-o", alone]);
        await ask("Page.navigate", { url: "about:blank" });
        await ask("Page.navigate", { url: `file://${alone}` });
        await until("the page of a song", `${shown("demo")} === "Play"`);
        await evaluate(`document.getElementById("demo").click()`);
        await until("its song", plays);
        await until("its scenes", state);
    }
    console.log("pages of a song play without a server, with a scene and with a show");
    console.log("the demo plays with a show, the key N shows the next scene, mistakes are shown, and a link brings the text back");
} finally {
    session = undefined;
    await ask("Browser.close").catch(() => process_.kill());
    server.close();
    await ended;
    // Some of Chromium's processes end a little later.
    rmSync(stills, { recursive: true, force: true, maxRetries: 10, retryDelay: 300 });
}
