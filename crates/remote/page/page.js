"use strict";

// The phone page: sends the user's input to the show and displays the show's state. It stores nothing.

const NEWS_LOST = 12000;     // Milliseconds without a message after which the connection counts as lost.
const AGAIN = [300, 600, 1200, 2500, 5000];
const ASK_TIME = 4000;       // Timeout of a request, in milliseconds.
const SAY_INTERVAL = 33;     // Milliseconds between two values of a moving slider.
const CLICK_LATE = 700;      // Milliseconds within which a browser may turn a touch into a click.
const TOUCH_SLACK = 6;       // Horizontal pixels after which a touch moves a slider instead of the page.

const at = (id) => document.getElementById(id);
const show = { scene: "", scenes: [], params: [], values: {}, switches: {}, levels: {}, tempo: 0, track: "", length: 0 };
const sliders = new Map();   // By "param:NAME" and "level:NAME".
let socket = null, tries = 0, retry = 0, watch = 0;
const unsaid = new Map();    // The newest value of each moving slider.
let sayAt = 0;

function make(kind, name, text) {
  const element = document.createElement(kind);
  element.className = name || "";
  if (text !== undefined) element.textContent = text;
  return element;
}

// Browsers generate no click for a second finger while the first one holds a slider, so touches are tracked here.
// Clicks come from keyboards and screen readers.
function press(button, act, early) {
  let finger = null, acted = -Infinity;
  const actOnce = () => { acted = performance.now(); act(); };
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    finger = event.pointerId;
    if (early) actOnce();
  });
  button.addEventListener("pointercancel", () => { finger = null; });
  button.addEventListener("pointerup", (event) => {
    if (event.pointerId !== finger) return;
    finger = null;
    const box = button.getBoundingClientRect();
    const inside = event.clientX >= box.left && event.clientX <= box.right && event.clientY >= box.top && event.clientY <= box.bottom;
    if (inside && !early) actOnce();
  });
  button.addEventListener("click", () => { if (performance.now() - acted > CLICK_LATE) act(); });
}

// ---- Connection ----

function tell(words, calm) {
  at("status").textContent = words;
  at("status").className = calm ? "calm" : "";
  at("hands").inert = words !== "";
}

function connect() {
  clearTimeout(retry);
  const line = new WebSocket("ws://" + location.host + location.pathname + "hands");
  socket = line;
  line.onmessage = (message) => {
    if (line !== socket) return;
    tries = 0;
    alive();
    take(JSON.parse(message.data));
    tell("");
  };
  line.onclose = () => { if (line === socket) lost(); };
  alive();
}

function alive() {
  clearTimeout(watch);
  watch = setTimeout(() => {
    const line = socket;
    socket = null;
    if (line) line.close();
    lost();
  }, NEWS_LOST);
}

function later(milliseconds) {
  clearTimeout(retry);
  retry = setTimeout(ask, milliseconds);
}

function lost() {
  socket = null;
  clearTimeout(watch);
  unsaid.clear();
  tell("Connection lost. Trying again …");
  later(AGAIN[Math.min(tries++, AGAIN.length - 1)]);
}

// A failed WebSocket does not report the HTTP status, so a plain request to the same address checks it first.
async function ask() {
  clearTimeout(retry);
  const patience = new AbortController();
  setTimeout(() => patience.abort(), ASK_TIME);
  let answer;
  try {
    answer = await fetch(location.pathname + "hands", { cache: "no-store", signal: patience.signal });
  } catch {
    later(AGAIN[Math.min(tries++, AGAIN.length - 1)]);
    return;
  }
  if (answer.status === 403) {
    tell("This address is no longer valid: Mariana was restarted. Press J in its window and scan the new code.");
  } else if (answer.status === 503) {
    tell("Too many phones are connected. Close the page on one of them.");
    later(AGAIN[AGAIN.length - 1]);
  } else {
    connect();
  }
}

document.addEventListener("visibilitychange", () => {
  if (document.visibilityState === "visible" && !socket && at("status").textContent.startsWith("Connection")) later(0);
});

function say(message) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

// Only the newest value of each slider is sent, so that a slow connection gets no backlog.
function sayLater(key, message) {
  unsaid.set(key, message);
  if (!sayAt) sayAt = setTimeout(sayNow, 0);
}

function sayNow() {
  sayAt = 0;
  if (socket && socket.bufferedAmount > 0) {
    sayAt = setTimeout(sayNow, SAY_INTERVAL);
    return;
  }
  for (const message of unsaid.values()) say(message);
  const any = unsaid.size > 0;
  unsaid.clear();
  if (any) sayAt = setTimeout(sayNow, SAY_INTERVAL);
}

// ---- Updates from the show ----

function take(news) {
  for (const key of ["scene", "scenes", "params", "tempo", "track", "length"]) if (key in news) show[key] = news[key];
  if ("params" in news) show.values = {};
  for (const key of ["values", "switches", "levels"]) Object.assign(show[key], news[key]);
  if ("scene" in news || "scenes" in news) showScenes();
  if ("params" in news) makeSliders();
  for (const name in news.values) sliders.get("param:" + name)?.see(...news.values[name]);
  for (const name in news.levels || {}) sliders.get("level:" + name)?.see(news.levels[name]);
  if ("length" in news) sliders.get("level:position").see(show.levels.position);
  if (news.switches) showSwitches();
  if ("pictures" in news) askForPictures(news.pictures);
  if ("tempo" in news) at("tempo").textContent = show.tempo > 0 ? show.tempo.toFixed(1) : "tempo";
  if ("track" in news) at("track").textContent = show.track;
  at("song").hidden = typeof show.levels.volume !== "number";
}

function showScenes() {
  at("scene").textContent = show.scene || "Mariana";
  document.title = show.scene ? show.scene + " – Mariana" : "Mariana";
  const grid = at("scenes");
  const is = [...grid.children].map((button) => button.textContent);
  if (is.length !== show.scenes.length || is.some((name, place) => name !== show.scenes[place])) {
    grid.replaceChildren(...show.scenes.map((name) => {
      const button = make("button", "");
      button.append(picture(name), make("span", "", name));
      press(button, () => say({ do: "scene", with: name }));
      return button;
    }));
  }
  for (const button of grid.children) button.setAttribute("aria-current", String(button.textContent === show.scene));
}

// Images load lazily. An image that does not exist yet is requested again when new ones arrive.
function picture(name) {
  const image = make("img");
  image.alt = "";
  image.loading = "lazy";
  image.decoding = "async";
  image.draggable = false;
  image.onload = () => image.classList.remove("missing");
  image.onerror = () => image.classList.add("missing");
  image.src = "picture/" + encodeURIComponent(name);
  return image;
}

function askForPictures(count) {
  for (const image of document.querySelectorAll("#scenes img.missing")) image.src = image.src.split("?")[0] + "?" + count;
}

function showSwitches() {
  for (const button of document.querySelectorAll("button.switch")) {
    const on = show.switches[button.dataset.do];
    button.hidden = on === undefined;
    button.setAttribute("aria-pressed", String(on === true));
  }
}

// ---- Sliders ----

function makeSliders() {
  const place = at("sliders");
  for (const param of show.params) param.key = "param:" + param.name;
  for (const key of [...sliders.keys()]) if (key.startsWith("param:")) sliders.delete(key);
  place.replaceChildren(place.firstElementChild, ...show.params.map((param) => {
    const root = make("div", "slider");
    root.dataset.param = param.name;
    slider(root, param.key, {
      name: param.name, min: param.min, max: param.max, usual: param.default,
      words: (value) => tidy(value, param.max - param.min),
      say: (to) => ({ turn: param.name, to }),
    });
    return root;
  }));
  place.hidden = show.params.length === 0;
}

function tidy(value, range) {
  const digits = range >= 100 ? 0 : range >= 10 ? 1 : 2;
  return value.toFixed(digits);
}

function clock(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return Math.floor(whole / 60) + ":" + String(whole % 60).padStart(2, "0");
}

function slider(root, key, about) {
  const { min, max } = about;
  const rail = make("div", "rail"), fill = make("div", "fill"), knob = make("div", "knob"), value = make("output", "value");
  const name = make("div", "name", about.name), held_by = make("span", "held"), way = make("div", "way");
  let seen, moves = false;
  rail.tabIndex = 0;
  rail.setAttribute("role", "slider");
  rail.setAttribute("aria-label", about.name);
  rail.setAttribute("aria-valuemin", min);
  rail.setAttribute("aria-valuemax", max);
  name.append(held_by);
  rail.append(fill, knob);
  way.append(rail);
  root.append(name, value, way);
  const share = (to) => max > min ? Math.min(1, Math.max(0, (to - min) / (max - min))) : 0;
  if (about.usual !== undefined) {
    const mark = make("div", "default"), back = make("button", "back", "↺");
    mark.style.left = 100 * share(about.usual) + "%";
    rail.append(mark);
    back.setAttribute("aria-label", about.name + ": reset to the scene's value");
    press(back, () => { draw(about.usual); say(about.say(about.usual)); });
    way.append(back);
  }
  function draw(to) {
    seen = to;
    fill.style.transform = "scaleX(" + share(to) + ")";
    knob.style.left = "calc(" + 100 * share(to) + "% - " + 6 * share(to) + "px)";
    value.textContent = about.words(to);
    rail.setAttribute("aria-valuenow", to);
    rail.setAttribute("aria-valuetext", value.textContent);
  }
  function turn(to) {
    draw(Math.min(max, Math.max(min, to)));
    sayLater(key, about.say(seen));
  }
  function follow(event) {
    const box = rail.getBoundingClientRect();
    turn(min + (max - min) * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
  }
  // A touch may be meant to scroll the page: only a horizontal movement or a tap moves the slider.
  let finger = null, from = 0;
  rail.onpointerdown = (event) => {
    if (finger !== null || event.button !== 0) return;
    finger = event.pointerId;
    from = event.clientX;
    moves = event.pointerType === "mouse";
    rail.setPointerCapture(finger);
    if (moves) follow(event);
  };
  rail.onpointermove = (event) => {
    if (event.pointerId !== finger) return;
    moves ||= Math.abs(event.clientX - from) > TOUCH_SLACK;
    rail.classList.toggle("moved", moves);
    if (moves) follow(event);
  };
  const letGo = (event, counts) => {
    if (event.pointerId !== finger) return;
    finger = null;
    if (counts) follow(event);
    moves = false;
    rail.classList.remove("moved");
  };
  rail.onpointerup = (event) => letGo(event, true);
  rail.onpointercancel = (event) => letGo(event, false);
  rail.onkeydown = (event) => {
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 }[event.key];
    if (step) turn((seen ?? min) + step * (max - min) / 100);
    else if (event.key === "Home") turn(min);
    else if (event.key === "End") turn(max);
    else return;
    event.preventDefault();
  };
  sliders.set(key, {
    see(to, hand) {
      root.hidden = typeof to !== "number";
      if (hand !== undefined) held_by.textContent = hand === "text" ? "" : hand;
      if (!root.hidden && !moves) draw(to);
    },
  });
}

for (const root of document.querySelectorAll("[data-level]")) {
  const level = root.dataset.level;
  slider(root, "level:" + level, {
    name: root.dataset.name, min: 0, max: 1,
    words: level === "position"
      ? (value) => clock(value * show.length) + " / " + clock(show.length)
      : (value) => Math.round(100 * value) + " %",
    say: (to) => ({ do: level, with: to }),
  });
}

// ---- Buttons ----

for (const button of document.querySelectorAll("[data-do]")) {
  const name = button.dataset.do;
  const act = () => say(button.classList.contains("switch") ? { do: name, with: !show.switches[name] } : { do: name });
  // The tempo is tapped when the finger touches, not when it is lifted.
  press(button, act, name === "beat");
}

connect();
