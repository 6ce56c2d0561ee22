// The page: sound, controls, text and link. WebAssembly draws and listens (`Studio` in src/lib.rs).
import init, { Studio, demo_track, scene_names, scene_text } from "./mariana_page.js";

const of = (id) => document.getElementById(id);
const canvas = of("picture");
/// Seconds that are heard ahead of what is played: the analysis looks a little ahead.
const AHEAD = 0.4;
/// Seconds before a moment from which the sound is heard after a seek: beats need them.
const BEFORE = 13;
/// Seconds of the whole song that are heard for each frame, until its structure is known.
const WHOLE = 2;
/// The parts of the window's pixels that are drawn, the sharpest first.
const SCALES = [1, 0.71, 0.5, 0.35, 0.25];
const SLOW_FRAME = 1 / 28;

let studio;
let sound = null;
let audio = null;
let volume = null;
let names = [];
const shown = { name: "", text: "", interpreted: false };

function tell(words, seconds = 4) {
    of("message").textContent = words;
    clearTimeout(tell.timer);
    if (words && seconds) tell.timer = setTimeout(() => tell("", 0), 1000 * seconds);
}

// Sound: a decoded song, or a stream of blocks.

function speakers() {
    audio ??= new AudioContext({ latencyHint: "playback" });
    audio.resume();
    if (!volume) {
        volume = audio.createGain();
        volume.connect(audio.destination);
    }
    volume.gain.value = Number(of("volume").value);
}

class Song {
    constructor(title, buffer) {
        this.title = title;
        this.buffer = buffer;
        this.left = buffer.getChannelData(0);
        this.right = buffer.getChannelData(buffer.numberOfChannels > 1 ? 1 : 0);
        this.rate = buffer.sampleRate;
        this.place = 0;
        this.whole = 0;
        studio.begin_sound(this.rate, false);
        this.seek(0);
    }

    get seconds() {
        return this.buffer.duration;
    }

    get time() {
        if (!this.source) return this.place;
        const late = audio.outputLatency || audio.baseLatency || 0;
        return Math.min(this.seconds, Math.max(0, this.place + audio.currentTime - this.since - late));
    }

    play() {
        if (this.source) return;
        if (this.place >= this.seconds) this.seek(0);
        this.source = new AudioBufferSourceNode(audio, { buffer: this.buffer });
        this.source.connect(volume);
        this.source.onended = () => this.pause();
        this.since = audio.currentTime;
        this.source.start(0, this.place);
    }

    pause() {
        if (!this.source) return;
        this.place = this.time;
        this.source.onended = null;
        this.source.stop();
        this.source = null;
    }

    seek(seconds) {
        const plays = Boolean(this.source);
        this.pause();
        this.place = Math.min(Math.max(seconds, 0), this.seconds);
        this.skipTo(this.place);
        if (plays) this.play();
    }

    skipTo(seconds) {
        this.heard = Math.max(0, Math.floor((seconds - BEFORE) * this.rate));
        studio.seek(this.heard);
    }

    /// Lets the studio hear all that it needs for the picture of this moment.
    hear(time) {
        const until = Math.min(this.left.length, Math.ceil((time + AHEAD) * this.rate));
        // A hidden page draws nothing while its song plays on.
        if (until - this.heard > 2 * BEFORE * this.rate) this.skipTo(time);
        if (until > this.heard) {
            studio.hear(this.left.subarray(this.heard, until), this.right.subarray(this.heard, until));
            this.heard = until;
        }
        if (this.whole < this.left.length) {
            const end = this.whole + Math.floor(WHOLE * this.rate);
            studio.hear_whole(this.left.subarray(this.whole, end), this.right.subarray(this.whole, end));
            this.whole = end;
            if (this.whole >= this.left.length) studio.finish_whole();
        }
    }

    end() {
        this.pause();
    }
}

const LISTENER = `registerProcessor("mariana-listener", class extends AudioWorkletProcessor {
    process([input]) {
        if (input.length) this.port.postMessage([input[0], input[1] ?? input[0]]);
        return true;
    }
});`;

class Live {
    constructor(title, stream) {
        this.title = title;
        this.stream = stream;
        this.samples = 0;
        studio.begin_sound(audio.sampleRate, true);
    }

    async listen() {
        const code = URL.createObjectURL(new Blob([LISTENER], { type: "text/javascript" }));
        await audio.audioWorklet.addModule(code);
        URL.revokeObjectURL(code);
        this.input = audio.createMediaStreamSource(this.stream);
        this.node = new AudioWorkletNode(audio, "mariana-listener", { numberOfOutputs: 0 });
        this.node.port.onmessage = ({ data: [left, right] }) => {
            studio.hear(left, right);
            this.samples += left.length;
        };
        this.input.connect(this.node);
        return this;
    }

    get time() {
        return this.samples / audio.sampleRate;
    }

    hear() {}

    end() {
        this.input?.disconnect();
        this.node?.disconnect();
        this.stream.getTracks().forEach((track) => track.stop());
    }
}

function begin(next) {
    sound?.end();
    sound = next;
    of("welcome").hidden = true;
    const isSong = next instanceof Song;
    for (const id of ["play", "seek"]) of(id).disabled = !isSong;
    document.title = next.title ? `${next.title} - Mariana` : "Mariana";
    if (isSong) next.play();
}

async function play(title, bytes) {
    speakers();
    tell(`Reading ${title}`, 0);
    try {
        begin(new Song(title, await audio.decodeAudioData(bytes)));
        tell(title);
    } catch {
        tell(`${title} is no sound that this browser can play: try MP3, Ogg, FLAC, M4A or WAV`, 8);
    }
}

const openFile = (file) => file && file.arrayBuffer().then((bytes) => play(file.name.replace(/\.[^.]*$/, ""), bytes));

async function listen(title, ask, refused) {
    speakers();
    try {
        const stream = await ask();
        if (!stream.getAudioTracks().length) throw new Error("no sound");
        begin(await new Live(title, stream).listen());
        tell(title);
    } catch {
        tell(refused, 8);
    }
}

const CLEAN = { echoCancellation: false, noiseSuppression: false, autoGainControl: false };
const microphone = () =>
    listen(
        "Microphone",
        () => navigator.mediaDevices.getUserMedia({ audio: CLEAN }),
        "There is no microphone, or this page may not use it: allow it beside the address",
    );
const tabSound = () =>
    listen(
        "Sound of a tab",
        () => navigator.mediaDevices.getDisplayMedia({ video: true, audio: CLEAN }),
        "No sound came: choose a tab, and tick its sound in the browser's question",
    );

// Scenes and their text.

function show(name, text, interpreted = shown.interpreted) {
    try {
        const begun = performance.now();
        studio.load(name, text, interpreted);
        of("mistakes").textContent = "";
        Object.assign(shown, { name, text, interpreted });
        of("scene").value = name;
        of("mode").textContent = interpreted ? "Interpreted" : "Compiled";
        fillSliders();
        console.info(`${name}: ${Math.round(performance.now() - begun)} ms`);
        return true;
    } catch (mistakes) {
        of("mistakes").textContent = String(mistakes);
        if (of("editor").hidden) tell(`${name} cannot be shown: ${String(mistakes).split("\n")[0]}`, 8);
        return false;
    }
}

function choose(name) {
    const text = scene_text(name);
    if (text && show(name, text)) {
        of("text").value = text;
        tell(name);
    }
}

function step(by) {
    const at = names.indexOf(shown.name);
    choose(names[(at + by + names.length) % names.length]);
}

function fillSliders() {
    const values = studio.slider_values();
    const rows = studio.slider_names().map((name, at) => {
        const [value, min, max] = values.subarray(3 * at, 3 * at + 3);
        const row = document.createElement("label");
        const [title, number, slider] = ["span", "output", "input"].map((tag) => document.createElement(tag));
        title.textContent = name.replaceAll("_", " ");
        number.textContent = value.toPrecision(3);
        Object.assign(slider, { type: "range", min, max, step: "any", value, name });
        slider.oninput = () => {
            studio.turn(name, Number(slider.value));
            number.textContent = Number(slider.value).toPrecision(3);
        };
        row.append(title, number, slider);
        return row;
    });
    if (!rows.length) rows.push("This scene has no sliders");
    of("sliders").replaceChildren(...rows);
}

// The link: name, text if it was changed, and turned sliders, compressed.

async function packed(bytes, stream) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

async function linkOf() {
    const sliders = {};
    for (const input of of("sliders").querySelectorAll("input")) sliders[input.name] = Number(input.value);
    const state = { name: shown.name, sliders };
    if (shown.text !== scene_text(shown.name)) state.text = shown.text;
    const bytes = await packed(new TextEncoder().encode(JSON.stringify(state)), new CompressionStream("deflate-raw"));
    const letters = btoa(String.fromCharCode(...bytes));
    return letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function showLink(link) {
    try {
        const letters = atob(link.replaceAll("-", "+").replaceAll("_", "/"));
        const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
        const unpacked = await packed(bytes, new DecompressionStream("deflate-raw"));
        const state = JSON.parse(new TextDecoder().decode(unpacked));
        const text = state.text ?? scene_text(state.name);
        if (typeof text !== "string" || !text || !show(String(state.name), text)) throw new Error("no scene");
        of("text").value = text;
        for (const [name, value] of Object.entries(state.sliders ?? {})) studio.turn(name, Number(value));
        fillSliders();
    } catch {
        tell("The address holds no scene that can be shown: it may have been cut off", 8);
        return false;
    }
    return true;
}

async function copyLink() {
    history.replaceState(null, "", `#${await linkOf()}`);
    try {
        await navigator.clipboard.writeText(location.href);
        tell("The link is copied");
    } catch {
        tell("The link is in the address bar");
    }
}

// Frames.

const pace = { scale: 0, late: 0, calm: 0, last: 0 };

/// Draws fewer pixels while frames are late, and tries more after a while.
function adapt(now) {
    const passed = (now - pace.last) / 1000;
    pace.last = now;
    if (passed > 0.5) return;
    pace.late = 0.9 * pace.late + 0.1 * passed;
    pace.calm = pace.late < SLOW_FRAME / 1.6 ? pace.calm + passed : 0;
    if (pace.late > SLOW_FRAME && pace.scale < SCALES.length - 1) {
        Object.assign(pace, { scale: pace.scale + 1, late: 0.02, patience: 2 * (pace.patience ?? 8) });
    } else if (pace.calm > (pace.patience ?? 8) && pace.scale > 0) {
        Object.assign(pace, { scale: pace.scale - 1, calm: 0 });
    }
}

const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

function frame(now) {
    requestAnimationFrame(frame);
    adapt(now);
    const scale = SCALES[pace.scale] * Math.min(devicePixelRatio, 2);
    const [width, height] = [innerWidth, innerHeight].map((side) => Math.max(1, Math.round(side * scale)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const time = sound ? sound.time : now / 1000;
    try {
        sound?.hear(time);
        studio.draw(time, width, height);
    } catch (error) {
        tell(`The picture stands: ${error}`, 8);
    }
    if (sound instanceof Song) {
        of("time").textContent = `${clock(time)} / ${clock(sound.seconds)}`;
        if (!frame.drags) of("seek").value = time / sound.seconds;
        of("play").textContent = sound.source ? "Pause" : "Play";
    }
}

// Controls.

const toggle = (panel, button) => {
    of(panel).hidden = !of(panel).hidden;
    of(button).setAttribute("aria-expanded", String(!of(panel).hidden));
};
const full = () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
const playOrPause = () => sound instanceof Song && (sound.source ? sound.pause() : (speakers(), sound.play()));
const otherMode = () => {
    tell(shown.interpreted ? "Compiling" : "Interpreted: the text is a list of clauses, run by one program");
    setTimeout(() => show(shown.name, shown.text, !shown.interpreted), 30);
};
const leap = (seconds) => sound instanceof Song && sound.seek(sound.time + seconds);

const KEYS = {
    " ": playOrPause, n: () => step(1), p: () => step(-1), c: otherMode, s: () => toggle("sliders", "turn"),
    e: () => toggle("editor", "edit"), f: full, l: copyLink, ArrowLeft: () => leap(-10), ArrowRight: () => leap(10),
};

function connect() {
    of("demo").onclick = () => play("Hadal Lanterns", demo_track().buffer);
    of("open").onclick = () => of("file").click();
    of("file").onchange = ({ target }) => openFile(target.files[0]);
    of("microphone").onclick = microphone;
    of("tab").onclick = tabSound;
    of("play").onclick = playOrPause;
    of("next").onclick = () => step(1);
    of("mode").onclick = otherMode;
    of("turn").onclick = KEYS.s;
    of("edit").onclick = KEYS.e;
    of("link").onclick = copyLink;
    of("full").onclick = full;
    of("scene").onchange = ({ target }) => choose(target.value);
    of("volume").oninput = () => volume && (volume.gain.value = Number(of("volume").value));
    of("seek").oninput = () => (frame.drags = true);
    of("seek").onchange = ({ target }) => {
        frame.drags = false;
        if (sound instanceof Song) sound.seek(target.value * sound.seconds);
    };
    let typed;
    of("text").oninput = ({ target }) => {
        clearTimeout(typed);
        typed = setTimeout(() => show(shown.name, target.value), 150);
    };
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.key === "Escape") document.activeElement?.blur();
        const typing = ["TEXTAREA", "SELECT"].includes(event.target.tagName);
        const sliding = event.target.tagName === "INPUT" && event.key.startsWith("Arrow");
        const pressing = event.target.tagName === "BUTTON" && event.key === " ";
        const action = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
        if (!action || typing || sliding || pressing) return;
        event.preventDefault();
        action();
    });
    const rows = new ResizeObserver(() => document.body.style.setProperty("--bar", `${of("bar").offsetHeight}px`));
    rows.observe(of("bar"));
    let rest;
    const wake = () => {
        document.body.classList.remove("quiet");
        clearTimeout(rest);
        rest = setTimeout(() => document.body.classList.toggle("quiet", of("welcome").hidden && of("editor").hidden && of("sliders").hidden), 3000);
    };
    for (const event of ["pointermove", "pointerdown", "keydown"]) addEventListener(event, wake);
    const drop = (event) => {
        event.preventDefault();
        document.body.classList.toggle("dropping", event.type === "dragover");
        if (event.type === "drop") openFile(event.dataTransfer.files[0]);
    };
    for (const event of ["dragover", "dragleave", "drop"]) addEventListener(event, drop);
    addEventListener("hashchange", () => location.hash.length > 1 && showLink(location.hash.slice(1)));
    canvas.addEventListener("webglcontextlost", () => tell("The browser has lost the picture: load the page again", 0));
}

async function start() {
    tell("Loading", 0);
    await init({ module_or_path: new URL("mariana_page_bg.wasm", import.meta.url) });
    const context = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "high-performance" });
    if (!context) throw new Error("this browser has no WebGL 2: try a current Firefox, Chrome or Safari with graphics acceleration");
    studio = new Studio(context);
    names = scene_names();
    of("scene").replaceChildren(...names.map((name) => new Option(name.replaceAll("_", " "), name)));
    connect();
    const linked = location.hash.length > 1 && (await showLink(location.hash.slice(1)));
    if (!linked) choose("orb");
    tell("", 0);
    requestAnimationFrame(frame);
}

start().catch((error) => tell(`Mariana cannot start here: ${error.message ?? error}`, 0));
