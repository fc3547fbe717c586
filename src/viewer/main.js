// The page: wires what the program says, what is seen, and what the user does.

import { Camera } from "./camera.js";
import { copy } from "./clipboard.js";
import { Compare } from "./compare.js";
import { addKeys } from "./keys.js";
import { Layers } from "./layer.js";
import { Link } from "./link.js";
import { Panel } from "./panel.js";
import { addPointer } from "./pointer.js";
import { Screen } from "./screen.js";
import { cannot, say, showLink, showNotes, showProbe, showState } from "./status.js";
import { showVariants } from "./variants.js";

const $ = (id) => document.getElementById(id);

const screen = made();
const layers = new Layers(screen);
const compare = new Compare(screen, layers);
const link = new Link({ hear, tiles: (part) => screen.tiles(part), state: learnLink });
const send = (request) => {
  if (["revert", "through"].includes(request.do)) camera.follow();
  link.send(request);
};
const camera = new Camera(send);
const panel = new Panel(send);
let state = { phase: "loading", size: [0, 0], snapshots: [] };
// How the program says that images are looked at.
let meant = { exposure: 0, tone_map: "agx" };

function made() {
  try {
    return new Screen($("canvas"), () => {
      forget();
      link.again();
    });
  } catch (error) {
    cannot(error.message);
    throw error;
  }
}

// Images that are here are those of a program that may be gone, or the graphics card has lost them.
function forget() {
  screen.now.forget();
  layers.forget();
  compare.forget();
}

function hear(document) {
  if (document.type === "state") learn(document);
  else if (document.type === "scene") {
    camera.learn(document.camera);
    panel.learn(document);
    showVariants(document.imports, send);
    showNotes(document.notes);
    if (document.view) begin(document.view);
  } else if (document.type === "probe" && pointer.isOver()) {
    showProbe(document);
    if (document.hit?.material && pointer.chosen(document.x, document.y)) panel.choose(document.hit.material);
  }
}

function learn(next) {
  const isResized = next.image > 0 && String(next.size) !== String(screen.view.size);
  const isWhole = String(next.window) === String([0, 0, ...next.size]);
  screen.view.region = isWhole || next.image === 0 ? null : next.window;
  const isBetter = next.image !== state.image || next.rounds !== state.rounds;
  state = next;
  showState(state);
  compare.learn(state.snapshots);
  if (isBetter && pointer.isOver()) pointer.look();
  if (isResized) {
    screen.view.size = next.size;
    screen.fit();
  }
  screen.draw();
  layers.follow(state);
  document.body.dataset.region = screen.view.region ?? "";
  document.body.dataset.image = next.image;
  document.body.dataset.phase = next.phase;
}

// Takes what the scene says, when it says something else than before: what was chosen here stays.
function begin(view) {
  if (view.exposure !== meant.exposure) setExposure(view.exposure);
  if (view.tone_map !== meant.tone_map) setCurve(view.tone_map);
  meant = view;
}

function learnLink(is) {
  showLink(is);
  if (is === "open") return;
  document.body.dataset.phase = "offline";
  forget();
}

function setExposure(stops) {
  screen.view.exposure = Math.min(Math.max(stops, -8), 8);
  $("exposure").value = screen.view.exposure;
  $("exposure-value").textContent = `${screen.view.exposure > 0 ? "+" : ""}${screen.view.exposure} EV`;
  screen.draw();
}

function setCurve(curve) {
  screen.view.curve = $("tonemap").value = curve;
  screen.draw();
}

function save() {
  screen.png((blob) => {
    if (!blob) return say("The image is too large for this browser to save.");
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: "ajar.png" });
    link.click();
    URL.revokeObjectURL(link.href);
  });
}

const actions = {
  run: () => send({ do: state.phase === "rendering" ? "stop" : "continue" }),
  restart: () => send({ do: "restart" }),
  fit: () => screen.fit(),
  actual: () => screen.actual(),
  wipe: () => compare.toggle("wipe"),
  swap: () => compare.toggle("before"),
  layer: () => layers.next(),
  difference: () => compare.toggle("difference"),
  save,
  exposure: (by) => setExposure(by === 0 ? meant.exposure : screen.view.exposure + by),
  curve: () => setCurve($("tonemap").options[($("tonemap").selectedIndex + 1) % $("tonemap").options.length].value),
  clay: () => send({ do: "clay", show: !state.is_clay }),
  falseColor: () => setCurve(screen.view.curve === "false" ? "agx" : "false"),
  panel: () => document.body.classList.toggle("bare"),
  help: () => $("help").showModal(),
  tool: (name) => pointer.choose(name),
  whole: () => send({ do: "region", pixels: null }),
};

const pointer = addPointer({ screen, camera, send });
addKeys(actions);

$("run").onclick = actions.run;
$("restart").onclick = actions.restart;
$("png").onclick = save;
$("help-button").onclick = actions.help;
$("panel-button").onclick = actions.panel;
for (const id of ["fit", "actual", "clay"]) $(id).onclick = actions[id];
$("camera-tool").onclick = () => pointer.choose("camera");
$("region-tool").onclick = () => (state.phase !== "loading" && screen.view.region ? actions.whole() : pointer.choose("region"));
$("exposure").oninput = (event) => setExposure(Number(event.target.value));
$("balance").oninput = (event) => {
  screen.view.balance = Number(event.target.value);
  $("balance-value").textContent = event.target.value;
  screen.draw();
};
$("tonemap").onchange = (event) => setCurve(event.target.value);
$("copy").onclick = () => copy(state.edits);
$("copy-camera").onclick = () => copy(camera.toml());
$("save").onclick = () => send({ do: "save" });
$("revert").onclick = () => send({ do: "revert" });
