// The page: wires what the program says, what is seen, and what the user does.

import { Camera } from "./camera.js";
import { addKeys } from "./keys.js";
import { Layers } from "./layer.js";
import { Link } from "./link.js";
import { Panel } from "./panel.js";
import { addPointer } from "./pointer.js";
import { Screen } from "./screen.js";
import { showNotes, showProbe, showState } from "./status.js";
import { showVariants } from "./variants.js";

const $ = (id) => document.getElementById(id);

const screen = new Screen($("canvas"));
const link = new Link({ hear, tiles: (part) => screen.tiles(part), state: showLink });
const send = (request) => link.send(request);
const camera = new Camera(send);
const panel = new Panel(send);
const layers = new Layers(screen);
let state = { phase: "loading", size: [0, 0], snapshots: [] };
let compared = null;

function hear(document) {
  if (document.type === "state") learn(document);
  else if (document.type === "scene") {
    camera.learn(document.camera);
    panel.learn(document);
    showVariants(document.imports, send);
    showNotes(document.notes);
  } else if (document.type === "probe") {
    showProbe(document);
    if (document.hit?.material && pointer.chosen(document.x, document.y)) panel.choose(document.hit.material);
  }
}

function learn(next) {
  const isResized = next.image > 0 && String(next.size) !== String(screen.view.size);
  const isWhole = String(next.window) === String([0, 0, ...next.size]);
  screen.view.region = isWhole || next.image === 0 ? null : next.window;
  state = next;
  showState(state);
  showSnapshots();
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

function showLink(isOpen) {
  $("offline").hidden = isOpen;
  document.body.dataset.link = isOpen ? "open" : "closed";
  if (!isOpen) {
    screen.now.forget();
    layers.forget();
    $("phase").textContent = "offline";
    $("phase").dataset.phase = "offline";
  }
}

// Images of before, the newest first.
function showSnapshots() {
  const list = $("snapshots");
  const names = JSON.stringify([state.snapshots, compared]);
  if (list.dataset.names === names) return;
  list.dataset.names = names;
  const buttons = state.snapshots.toReversed().map(({ image, changed, samples }) => {
    const text = `${image}  ${changed.join(", ") || "first image"}, ${samples} spp`;
    const button = Object.assign(document.createElement("button"), { textContent: text, title: text });
    button.onclick = () => compare(image);
    button.classList.toggle("on", image === compared);
    return button;
  });
  if (buttons.length) list.replaceChildren(...buttons);
  for (const id of ["wipe", "swap", "difference"]) $(id).disabled = buttons.length === 0;
}

async function compare(image) {
  const answer = await fetch(new URL(`image/${image}`, location.href));
  if (!answer.ok) return;
  screen.before.add(await answer.arrayBuffer());
  compared = image;
  showSnapshots();
  if (screen.view.mode === "now") setMode("wipe");
  screen.draw();
}

async function setMode(mode) {
  const next = screen.view.mode === mode ? "now" : mode;
  if (next !== "now") layers.choose("");
  if (next !== "now" && compared === null) {
    const last = state.snapshots.at(-1);
    if (!last) return;
    screen.view.mode = next;
    await compare(last.image);
  }
  screen.view.mode = next;
  for (const [id, name] of [["wipe", "wipe"], ["swap", "before"], ["difference", "difference"]]) {
    $(id).classList.toggle("on", next === name);
  }
  $("wiper").hidden = next !== "wipe";
  $("wiper").style.left = `${screen.view.wipe * 100}%`;
  document.body.dataset.mode = next;
  screen.draw();
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
  $("canvas").toBlob((blob) => {
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: "ajar.png" });
    link.click();
    URL.revokeObjectURL(link.href);
  });
}

const actions = {
  run: () => send({ do: state.phase === "rendering" ? "stop" : "continue" }),
  restart: () => send({ do: "restart" }),
  fit: () => screen.fit(),
  actual: () => screen.zoomAt($("canvas").clientWidth / 2, $("canvas").clientHeight / 2, 1 / screen.view.zoom / devicePixelRatio),
  wipe: () => setMode("wipe"),
  swap: () => setMode("before"),
  layer: () => layers.next(),
  difference: () => setMode("difference"),
  save,
  exposure: (by) => setExposure(by === 0 ? 0 : screen.view.exposure + by),
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
for (const id of ["fit", "actual", "clay", "wipe", "swap", "difference"]) $(id).onclick = actions[id];
$("camera-tool").onclick = () => pointer.choose("camera");
$("region-tool").onclick = () => (state.phase !== "loading" && screen.view.region ? actions.whole() : pointer.choose("region"));
$("exposure").oninput = (event) => setExposure(Number(event.target.value));
$("balance").oninput = (event) => {
  screen.view.balance = Number(event.target.value);
  $("balance-value").textContent = event.target.value;
  screen.draw();
};
$("tonemap").onchange = (event) => setCurve(event.target.value);
$("copy").onclick = () => navigator.clipboard.writeText(state.edits);
$("save").onclick = () => send({ do: "save" });
$("revert").onclick = () => send({ do: "revert" });
