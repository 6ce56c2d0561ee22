// The page: sound, controls, text and link. WebAssembly draws and listens (`Studio` in src/lib.rs).
const { Studio, demo_track, scene_names, scene_text } = wasm_bindgen;

const of = (id) => document.getElementById(id);
const canvas = of("picture");
/// What `mariana page` wrote into the page: title, scene or show, and structure of its song.
const own = JSON.parse(of("own").textContent);
/// Seconds that are heard ahead of what is played: the analysis looks a little ahead.
const AHEAD = 0.4;
/// Seconds before a moment from which the sound is heard after a seek: beats need them.
const BEFORE = 13;
/// The parts of the window's pixels that are drawn, the sharpest first.
const SCALES = [1, 0.71, 0.5, 0.35, 0.25];
const SLOW_FRAME = 1 / 28;
/// Milliseconds of a frame for hearing the whole song, and seconds of it at a time.
const WHOLE = { budget: 4, seconds: 0.25 };
/// Decoded songs take 23 MB of memory a minute.
const SONG_MINUTES_MAX = 40;
/// A longer text is no scene.
const LINK_BYTES_MAX = 2_000_000;

/// Milliseconds between two scenes that the director gets to know.
const CARD_EVERY = 250;

let studio;
let sound = null;
let audio = null;
let volume = null;
let names = [];
const shown = { name: "", text: "", interpreted: false };
/// The chosen scene while the browser compiles it, with the sliders of its link.
let coming = null;
/// The show: `wanted` by the user, `runs` now. `knows`: the director has read all scenes, the last one at the time `last`.
const directed = { wanted: true, runs: false, knows: false, last: 0 };
/// The name of the scene whose text is in the editor, and the timer of its typed text.
const edited = { name: "", timer: 0 };

function tell(words, seconds = 4) {
    of("message").textContent = words;
    clearTimeout(tell.timer);
    if (words && seconds) tell.timer = setTimeout(() => tell("", 0), 1000 * seconds);
}

// Sound: a decoded song, or a stream of blocks.

function speakers() {
    audio ??= new AudioContext({ latencyHint: "playback" });
    audio.resume();
    // Some browsers allow sound only from a click on.
    if (audio.state !== "running") addEventListener("pointerup", () => audio.resume(), { once: true });
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
    }

    begin() {
        studio.begin_sound(this.rate, false);
        this.seek(0);
        if (this.structure) this.know();
        this.play();
    }

    /// Uses the structure that `mariana page` has found.
    know() {
        try {
            studio.know_song(JSON.stringify(this.structure));
            this.whole = this.left.length;
            followShow();
        } catch {
            this.structure = undefined;
            tell("The page's song is from another version of Mariana: write the page again", 8);
        }
    }

    get seconds() {
        return this.buffer.duration;
    }

    get time() {
        if (!this.source) return this.place;
        const late = audio.outputLatency || audio.baseLatency || 0;
        return Math.min(this.seconds, this.place + Math.max(0, audio.currentTime - this.since - late));
    }

    play() {
        if (this.source) return;
        if (this.place >= this.seconds) this.seek(0);
        this.source = new AudioBufferSourceNode(audio, { buffer: this.buffer });
        this.source.connect(volume);
        this.source.onended = () => {
            this.pause();
            this.place = this.seconds;
            if (own.loop) this.play();
        };
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
            studio.push_samples(this.left.subarray(this.heard, until), this.right.subarray(this.heard, until));
            this.heard = until;
        }
        const asksDirector = directed.wanted && !directed.runs && !own.scene && !directed.knows;
        if (asksDirector && performance.now() > directed.last + CARD_EVERY) {
            directed.knows = !studio.read_next_card();
            directed.last = performance.now();
            if (directed.knows && this.whole >= this.left.length) followShow();
        }
        const until_ms = performance.now() + WHOLE.budget;
        while (this.whole < this.left.length && performance.now() < until_ms) {
            const end = this.whole + Math.floor(WHOLE.seconds * this.rate);
            studio.push_song(this.left.subarray(this.whole, end), this.right.subarray(this.whole, end));
            this.whole = end;
            if (this.whole < this.left.length) continue;
            studio.finish_song();
            if (directed.knows) followShow();
        }
    }

    end() {
        this.pause();
    }
}

const LISTENER = `registerProcessor("mariana-listener", class extends AudioWorkletProcessor {
    constructor() {
        super();
        this.port.onmessage = () => (this.ends = true);
    }
    process([input]) {
        if (input.length) this.port.postMessage([input[0], input[1] ?? input[0]]);
        return !this.ends;
    }
});`;

class Live {
    constructor(title, stream) {
        this.title = title;
        this.stream = stream;
        this.samples = 0;
    }

    begin() {
        studio.begin_sound(audio.sampleRate, true);
        this.node.port.onmessage = ({ data: [left, right] }) => {
            studio.push_samples(left, right);
            this.samples += left.length;
        };
    }

    async listen() {
        const code = URL.createObjectURL(new Blob([LISTENER], { type: "text/javascript" }));
        await audio.audioWorklet.addModule(code);
        URL.revokeObjectURL(code);
        this.input = audio.createMediaStreamSource(this.stream);
        this.node = new AudioWorkletNode(audio, "mariana-listener", { numberOfOutputs: 0 });
        this.input.connect(this.node);
        this.stream.getAudioTracks()[0].onended = () => tell(`${this.title} has ended`);
        return this;
    }

    get time() {
        return this.samples / audio.sampleRate;
    }

    hear() {}

    end() {
        this.node.port.onmessage = null;
        this.node.port.postMessage("end");
        this.input.disconnect();
        this.node.disconnect();
        this.stream.getTracks().forEach((track) => track.stop());
    }
}

function begin(next) {
    sound?.end();
    sound = next;
    setShowRuns(false);
    of("scene").value = coming?.name ?? shown.name;
    of("welcome").hidden = true;
    const isSong = next instanceof Song;
    for (const id of ["play", "seek", "follow"]) of(id).disabled = !isSong;
    document.title = next.title ? `${next.title} - Mariana` : "Mariana";
    next.begin();
}

async function play(title, bytes, structure) {
    speakers();
    tell(`Reading ${title}`, 0);
    const buffer = await audio.decodeAudioData(bytes).catch(() => null);
    if (!buffer) return tell(`${title} is no sound that this browser can play: try MP3, Ogg, FLAC, M4A or WAV`, 8);
    if (buffer.duration > 60 * SONG_MINUTES_MAX) return tell(`${title} is longer than ${SONG_MINUTES_MAX} minutes: choose a part`, 8);
    begin(Object.assign(new Song(title, buffer), { structure }));
    tell(title);
}

async function openFile(file) {
    if (!file) return tell("Drop a file of sound");
    // Before anything is awaited, because browsers allow sound only at once after a click.
    speakers();
    const bytes = await file.arrayBuffer().catch(() => null);
    if (bytes) await play(file.name.replace(/\.[^.]*$/, ""), bytes);
    else tell(`${file.name} cannot be read: choose a file, not a folder`, 8);
}

async function listen(title, ask, refused) {
    speakers();
    let stream;
    try {
        stream = await ask();
        if (!stream.getAudioTracks().length) throw new Error("no sound");
        begin(await new Live(title, stream).listen());
        tell(title);
    } catch {
        stream?.getTracks().forEach((track) => track.stop());
        tell(isSecureContext ? refused : "Browsers give sound only to pages with https, and on this computer", 8);
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
        "No sound came: Chrome and Edge share a tab's sound; choose a tab, and tick its sound in the question",
    );

// Scenes and their text.

/// Shows mistakes of the scene, or ends everything for what is no mistake.
function report(name, mistakes) {
    // The studio reports what it refuses as a text. Anything else is the end of it.
    if (typeof mistakes !== "string") return stop(mistakes.message);
    of("mistakes").textContent = mistakes;
    if (of("editor").hidden) tell(`${name} cannot be shown: ${mistakes.split("\n")[0]}`, 8);
    else if (of("message").textContent.startsWith("Compiling")) tell("", 0);
    return false;
}

/// Chooses a scene, which comes once the browser has compiled it ([`receive`]). Returns false if it has mistakes.
function show(name, text, interpreted = (coming ?? shown).interpreted, sliders = {}) {
    try {
        studio.load(name, text, interpreted);
        of("mistakes").textContent = "";
        coming = { name, text, interpreted, sliders, begun: performance.now() };
        return true;
    } catch (mistakes) {
        return report(name, mistakes);
    }
}

/// Shows the chosen scene as soon as it is compiled.
function receive() {
    try {
        if (!coming || !studio.receive_scene(coming.behind)) return;
    } catch (mistakes) {
        report(coming.name, mistakes);
        coming = null;
        return;
    }
    const { name, text, interpreted, sliders, begun, behind } = coming;
    for (const [slider, value] of Object.entries(sliders)) studio.turn(slider, Number(value));
    coming = null;
    Object.assign(shown, { name, text, interpreted });
    Object.assign(pace, { late: 0, calm: 0, patience: PATIENCE });
    of("mode").textContent = interpreted ? "Interpreted" : "Compiled";
    if (of("message").textContent.startsWith("Compiling")) tell(name);
    if (!behind) {
        of("scene").value = name;
        setShowRuns(false);
    }
    console.info(`${name}: ${Math.round(performance.now() - begun)} ms`);
}

/// A scene that the user chooses stays: the show ends.
function choose(name, text = scene_text(name)) {
    directed.wanted = false;
    clearTimeout(edited.timer);
    of("scene").value = name;
    tell(`Compiling ${name}`, 0);
    if (!show(name, text)) return;
    of("text").value = text;
    edited.name = name;
}

/// The scene that the show draws.
const present = () => ({ name: studio.scene_name(sound.time) || "orb", text: studio.scene_text_at(sound.time) });

function setShowRuns(runs) {
    directed.runs = runs;
    of("follow").setAttribute("aria-pressed", String(runs));
    fillSliders();
}

/// Lets the page's own show or the director choose the scenes of the song, if a show is wanted.
function followShow() {
    if (!directed.wanted || directed.runs) return;
    try {
        if (own.show && sound.structure) studio.follow_show(own.show, Object.keys(own.scenes), Object.values(own.scenes));
        else if (own.scene || !studio.follow_song()) return;
        setShowRuns(true);
        if (coming) coming.behind = true;
    } catch (mistakes) {
        if (typeof mistakes !== "string") return stop(mistakes.message);
        tell(`The show cannot be played: ${mistakes.split("\n")[0]}. Write the page again`, 8);
    }
}

/// Begins to follow the song, or keeps the present scene.
function toggleShow() {
    if (!(sound instanceof Song)) return;
    if (directed.runs) return choose(present().name, present().text);
    directed.wanted = true;
    delete own.scene;
    if (directed.knows || (own.show && sound.structure)) followShow();
    tell(directed.runs ? "The scenes follow the song" : "The show begins once the song is heard");
}

function step(by) {
    const at = names.indexOf(coming?.name ?? of("scene").value);
    choose(names[(at + by + names.length) % names.length]);
}

function fillSliders() {
    if (directed.runs) return of("sliders").replaceChildren("The show moves the scenes: press A to keep one");
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

/// Packs or unpacks bytes. Fails if the result is longer than `most`.
async function packed(bytes, stream, most = Infinity) {
    const pieces = [];
    let length = 0;
    for (const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader(); ; ) {
        const { done, value } = await reader.read();
        if (done) return new Uint8Array(await new Blob(pieces).arrayBuffer());
        pieces.push(value);
        length += value.length;
        if (length > most) throw new Error("too long");
    }
}

async function linkOf() {
    const { name, text, sliders = {} } = coming ?? (directed.runs ? present() : shown);
    if (!coming) for (const input of of("sliders").querySelectorAll("input")) sliders[input.name] = Number(input.value);
    const state = { name, sliders };
    if (text !== scene_text(name)) state.text = text;
    const bytes = await packed(new TextEncoder().encode(JSON.stringify(state)), new CompressionStream("deflate-raw"));
    const letters = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
    return letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function stateOf(link) {
    const letters = atob(link.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    const unpacked = await packed(bytes, new DecompressionStream("deflate-raw"), LINK_BYTES_MAX);
    const { name, text, sliders } = JSON.parse(new TextDecoder().decode(unpacked));
    return { name: String(name), text: String(text ?? scene_text(name)), sliders: sliders ?? {} };
}

async function showLink(link) {
    const state = await stateOf(link).catch(() => ({}));
    if (!state.text) {
        tell("The address holds no scene: it may have been cut off", 8);
        return false;
    }
    of("text").value = state.text;
    edited.name = state.name;
    directed.wanted = false;
    return show(state.name, state.text, shown.interpreted, state.sliders);
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

/// Seconds of fast frames after which more pixels are tried.
const PATIENCE = 8;
const pace = { scale: 0, late: 0, calm: 0, last: 0, patience: PATIENCE };

/// Draws fewer pixels while frames are late, and tries more after a while.
function adapt(now) {
    const passed = (now - pace.last) / 1000;
    pace.last = now;
    if (passed > 0.5) return;
    pace.late = 0.9 * pace.late + 0.1 * passed;
    pace.calm = pace.late < SLOW_FRAME / 1.6 ? pace.calm + passed : 0;
    if (pace.late > SLOW_FRAME && pace.scale < SCALES.length - 1) {
        Object.assign(pace, { scale: pace.scale + 1, late: 0.02, patience: Math.min(60, 2 * pace.patience) });
    } else if (pace.calm > pace.patience && pace.scale > 0) {
        Object.assign(pace, { scale: pace.scale - 1, calm: 0 });
    }
}

const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

/// Ends all frames, because the studio cannot draw any more.
function stop(reason) {
    frame.stopped = true;
    tell(`Mariana cannot go on: load the page again (${reason})`, 0);
    return false;
}

function frame(now) {
    if (frame.stopped) return;
    requestAnimationFrame(frame);
    adapt(now);
    const scale = SCALES[pace.scale] * Math.min(devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * scale)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const time = sound ? sound.time : now / 1000;
    try {
        sound?.hear(time);
        receive();
        studio.draw(time, width, height);
        const name = directed.runs && !coming && studio.scene_name(time);
        if (name && of("scene").value !== name) of("scene").value = name;
    } catch (error) {
        stop(error.message ?? error);
    }
    if (!(sound instanceof Song)) return;
    of("play").textContent = sound.source ? "Pause" : "Play";
    const words = `${clock(time)} / ${clock(sound.seconds)}`;
    if (of("time").textContent !== words) {
        of("time").textContent = words;
        of("seek").ariaValueText = words;
        if (!frame.drags) of("seek").value = time / sound.seconds;
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
    if (directed.runs) return tell("The show moves the scenes: press A to keep one");
    const { name, text, interpreted, sliders } = coming ?? shown;
    tell(interpreted ? "Compiling" : "Interpreted: the text is a list of clauses, run by one program");
    show(name, text, !interpreted, sliders);
};
const leap = (seconds) => sound instanceof Song && sound.seek(sound.time + seconds);

const edit = () => {
    if (directed.runs && of("editor").hidden) [of("text").value, edited.name] = [present().text, present().name];
    toggle("editor", "edit");
};

const KEYS = {
    " ": playOrPause, n: () => step(1), p: () => step(-1), c: otherMode, s: () => toggle("sliders", "turn"),
    e: edit, f: full, l: copyLink, a: toggleShow, ArrowLeft: () => leap(-10), ArrowRight: () => leap(10),
};

function connect() {
    of("demo").onclick = () => play("Hadal Lanterns", demo_track().buffer);
    of("open").onclick = () => of("file").click();
    of("file").onchange = ({ target }) => {
        openFile(target.files[0]);
        target.value = "";
    };
    of("full").hidden = !document.fullscreenEnabled;
    of("tab").hidden = !navigator.mediaDevices?.getDisplayMedia;
    of("microphone").onclick = microphone;
    of("tab").onclick = tabSound;
    of("play").onclick = playOrPause;
    of("next").onclick = () => step(1);
    of("mode").onclick = otherMode;
    of("turn").onclick = KEYS.s;
    of("edit").onclick = KEYS.e;
    of("link").onclick = copyLink;
    of("follow").onclick = toggleShow;
    of("full").onclick = full;
    of("scene").onchange = ({ target }) => choose(target.value);
    of("volume").oninput = () => volume && (volume.gain.value = Number(of("volume").value));
    of("seek").onpointerdown = () => (frame.drags = true);
    of("seek").onpointerup = of("seek").onblur = () => (frame.drags = false);
    of("seek").onchange = ({ target }) => {
        if (sound instanceof Song) sound.seek(target.value * sound.seconds);
    };
    of("text").oninput = ({ target }) => {
        clearTimeout(edited.timer);
        directed.wanted = false;
        edited.timer = setTimeout(() => show(edited.name, target.value), 150);
    };
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || (event.repeat && !event.key.startsWith("Arrow"))) return;
        if (event.key === "Escape") document.activeElement?.blur();
        const typing = ["TEXTAREA", "SELECT"].includes(event.target.tagName);
        const sliding = event.target.tagName === "INPUT" && event.key.startsWith("Arrow");
        const pressing = event.target.tagName === "BUTTON" && event.key === " ";
        const action = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
        const isLeftOut = own.embed && "nplcesa".includes(event.key.toLowerCase());
        if (!action || isLeftOut || typing || sliding || pressing) return;
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
    canvas.addEventListener("webglcontextlost", () => stop("the browser has lost the picture"));
}

/// The bytes of an element that holds them in base 64.
const bytesIn = async (id) => (await fetch(`data:;base64,${of(id).textContent}`)).arrayBuffer();

/// Greets with the page's own song.
function greetWithSong() {
    of("title").textContent = own.title;
    of("demo").textContent = "Play";
    of("demo").onclick = async () => play(own.title, await bytesIn("song"), own.structure);
    for (const id of ["claim", "hint", "open", "microphone", "tab"]) of(id).hidden = true;
    document.title = own.title;
}

async function start() {
    tell("Loading", 0);
    if (own.poster) of("welcome").style.background = `linear-gradient(#08090c99 0 0), center / cover url(${own.poster})`;
    document.body.classList.toggle("embed", Boolean(own.embed));
    const packedModule = of("module").textContent && (await bytesIn("module"));
    const module_or_path = packedModule ? await packed(packedModule, new DecompressionStream("gzip")) : "mariana_page_bg.wasm";
    await wasm_bindgen({ module_or_path });
    const context = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "high-performance" });
    if (!context) throw new Error("this browser has no WebGL 2: try a current Firefox, Chrome or Safari with graphics acceleration");
    studio = new Studio(context);
    names = scene_names();
    of("scene").replaceChildren(...names.map((name) => new Option(name.replaceAll("_", " "), name)));
    connect();
    if (own.title) greetWithSong();
    const linked = location.hash.length > 1 && (await showLink(location.hash.slice(1)));
    const name = own.scene ?? "orb";
    if (!linked) {
        edited.name = name;
        of("text").value = own.text ?? scene_text(name);
        show(name, of("text").value);
    }
    if (of("message").textContent === "Loading") tell("", 0);
    requestAnimationFrame(frame);
}

start().catch((error) => tell(`Mariana cannot start here: ${error.message ?? error}`, 0));
