"use strict";
// The viewer: what the planes of planes.js are shown as, and what keys and mouse do.

const $ = (id) => document.getElementById(id);
const WARM = "linear-gradient(90deg, #00f, #fff, #f00)";
const HOT = `linear-gradient(90deg, ${HEAT.map((c) => `rgb(${c})`)})`;
// A reference that was made anew is reviewed, not judged: beside the one of before, if there was one.
const { review } = data.verdict;
const alone = Boolean(review && data.verdict.problem);
const THEIRS = review ? "old reference" : "reference";
const capital = (text) => text[0].toUpperCase() + text.slice(1);
// Name, title, hint, and of maps the colours from one value to another.
const MODES = [
  ["swap", "Swap", "Hold the mouse button over the image, or the space bar, to see the other one; B blinks."],
  ["wipe", "Wipe", `Move over the image: the new one is left of the line, the ${THEIRS} right of it.`],
  ["new", "New", "The new image."],
  ["reference", capital(THEIRS), review ? "The image that was right before." : "The image that is right."],
  ["difference", "Difference", "Red where the new image is brighter, blue where it is darker.", WARM, "−50 %", "+50 %"],
  ["significance", "Beyond noise", "How far 8×8 blocks differ; noise alone stays dark.", HOT],
  ["flip", "FLIP", "What a person would notice when the images are swapped.", HOT, "nothing", "everything"],
];
// A block of a large image would not be found otherwise.
const SMALLEST_FRAME = 20;
const state = { mode: "swap", held: false, blink: 0, wipe: 0.5, exposure: 0, zoom: 0 };
const planes = {};

function writeText() {
  const v = data.verdict;
  const words = { pass: "Same picture", fail: "Different picture", cannot: "Cannot compare" };
  $("head").className = review ? "review" : v.outcome;
  $("word").textContent = review ? capital(review) : words[v.outcome];
  $("reason").textContent = v.reason;
  $("names").textContent = alone ? v.new : `${v.new}, compared with ${v.reference}`;
  $("theirs").textContent = alone ? "" : THEIRS;
  $("gates").hidden = !v.gates.length;
  $("command").textContent = data.command;
  $("numbers").textContent = JSON.stringify(v.gates, null, 1);
  v.gates.forEach((gate, i) => {
    // A change that is meant is no failure.
    const status = review && gate.status === "fail" ? "differs" : gate.status;
    const row = addRow($("gates"), [`${i + 1}  ${gate.gate}`, status, gate.message]);
    row.cells[1].className = status;
  });
  for (const line of v.exceptions) addRow($("gates"), ["", "excused", line]);
  for (const line of v.warnings) addRow($("gates"), ["", "warning", line]).cells[1].className = "warning";
  for (const line of data.about || []) addRow($("about"), alone ? line.slice(0, 2) : line);
  $("copy").onclick = async () => {
    await navigator.clipboard?.writeText(data.command);
    $("copy").textContent = "copied";
  };
}

function addRow(table, texts) {
  const row = table.tBodies[0].insertRow();
  for (const text of texts) row.insertCell().textContent = text;
  return row;
}

// Draws what is shown in a mode.
function paint(context, mode) {
  const { width, height } = data;
  const show = (canvas, w = width, h = height) => context.drawImage(canvas, 0, 0, w, h);
  context.imageSmoothingEnabled = false;
  if (mode === "wipe") {
    const x = Math.round(state.wipe * width);
    show(planes.reference);
    if (x > 0) context.drawImage(planes.new, 0, 0, x, height, 0, 0, x, height);
  } else if (mode === "significance" || mode === "flip") {
    // The last blocks may reach beyond the image, or not fill it.
    const side = (mode === "flip" ? data.flip_factor : 8) / data.factor;
    context.fillStyle = "#000";
    context.fillRect(0, 0, width, height);
    show(planes[mode], planes[mode].width * side, planes[mode].height * side);
  } else show(planes[mode]);
}

function draw() {
  const shown = state.mode === "swap" ? (state.held ? "reference" : "new") : state.mode;
  paint($("canvas").getContext("2d"), shown);
  $("canvas").dataset.shown = shown;
  $("left").textContent = { wipe: "new", new: "new", reference: THEIRS }[shown] || "";
  $("right").textContent = shown === "wipe" ? THEIRS : "";
  $("line").hidden = shown !== "wipe";
  $("line").style.left = `${100 * state.wipe}%`;
}

function drawThumbs() {
  for (const button of $("modes").children) {
    const context = button.querySelector("canvas").getContext("2d");
    const scale = Math.min(context.canvas.width / data.width, context.canvas.height / data.height);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    const { mode } = button.dataset;
    paint(context, mode === "swap" ? "new" : mode);
    context.fillStyle = "#ffd60a";
    if (mode === "wipe") context.fillRect(state.wipe * data.width, 0, 1 / scale, data.height);
  }
}

function layout() {
  const { width, height, block, factor, origin } = data;
  const fit = Math.min($("stage").clientWidth / width, (0.66 * innerHeight) / height);
  const zoom = state.zoom || (fit > 1 ? Math.floor(fit) : fit);
  Object.assign($("frame").style, { width: `${width * zoom}px`, height: `${height * zoom}px` });
  $("block").hidden = !block;
  if (!block) return;
  const [x0, y0, x1, y1] = block.map((v, i) => ((v - origin[i % 2]) / factor) * zoom);
  const [w, h] = [x1 - x0, y1 - y0].map((extent) => Math.max(extent, SMALLEST_FRAME));
  const style = { left: (x0 + x1 - w) / 2, top: (y0 + y1 - h) / 2, width: w, height: h };
  for (const [key, value] of Object.entries(style)) $("block").style[key] = `${value}px`;
}

function setMode(mode) {
  state.mode = mode;
  for (const button of $("modes").children) button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
  const [, , hint, colours, low, high] = MODES.find(([name]) => name === mode);
  const note = data.factor > 1 ? ` Each pixel here is the mean of ${data.factor}×${data.factor}.` : "";
  $("hint").textContent = hint + note;
  $("scale").hidden = !colours;
  $("exposure").disabled = Boolean(colours);
  $("scale").style.setProperty("--colours", colours || "none");
  $("low").textContent = low || `${data.significant[0]}`;
  $("high").textContent = high || `${data.significant[1]} standard errors`;
  draw();
}

function setExposure(stops) {
  state.exposure = stops;
  $("stops").textContent = `${stops >= 0 ? "+" : "−"}${Math.abs(stops).toFixed(1)} EV`;
  planes.new = toned(planes.newLinear);
  planes.reference = toned(planes.referenceLinear);
  draw();
  drawThumbs();
}

function readPixel(event) {
  const box = $("frame").getBoundingClientRect();
  const x = Math.floor(((event.clientX - box.left) / box.width) * data.width);
  const y = Math.floor(((event.clientY - box.top) / box.height) * data.height);
  if (x < 0 || y < 0 || x >= data.width || y >= data.height) return;
  const at = 3 * (y * data.width + x);
  const text = (linear) => Array.from(linear.slice(at, at + 3), (v) => v.toPrecision(3).padStart(9)).join(" ");
  const place = `(${x * data.factor + data.origin[0]}, ${y * data.factor + data.origin[1]})`;
  $("pixel").textContent =
    `pixel ${place}   new ${text(planes.newLinear)}` + (alone ? "" : `   ${THEIRS} ${text(planes.referenceLinear)}`);
}

function hold(held) {
  state.held = held;
  draw();
}

function toggleBlink() {
  if (alone) return;
  clearInterval(state.blink);
  state.blink = state.blink ? 0 : setInterval(() => hold(!state.held), 500);
  setMode("swap");
  if (!state.blink) hold(false);
}

function press(event) {
  if (event.target.matches("select") || event.ctrlKey || event.metaKey || event.altKey) return;
  const button = $("modes").children[Number(event.key) - 1];
  if (button) setMode(button.dataset.mode);
  if (event.key === "b") toggleBlink();
  if (event.key === " ") {
    event.preventDefault();
    if (!event.repeat) hold(true);
  }
}

function listen() {
  $("frame").onpointermove = (event) => {
    const box = $("frame").getBoundingClientRect();
    state.wipe = (event.clientX - box.left) / box.width;
    if (state.mode === "wipe") draw();
    readPixel(event);
  };
  $("frame").onpointerdown = () => hold(true);
  addEventListener("pointerup", () => hold(false));
  addEventListener("keydown", press);
  addEventListener("keyup", (event) => event.key === " " && hold(false));
  $("exposure").oninput = () => setExposure(Number($("exposure").value));
  $("zoom").onchange = () => {
    state.zoom = Number($("zoom").value);
    layout();
  };
  addEventListener("resize", layout);
}

function addButtons() {
  const modes = MODES.filter(([mode]) => (alone ? mode === "new" : mode !== "significance" || data.significance));
  modes.forEach(([mode, title], i) => {
    const button = $("modes").appendChild(document.createElement("button"));
    const thumb = button.appendChild(document.createElement("canvas"));
    const scale = Math.min(150 / data.width, 90 / data.height);
    Object.assign(thumb, { width: Math.ceil(data.width * scale), height: Math.ceil(data.height * scale) });
    button.dataset.mode = mode;
    button.append(title);
    button.appendChild(document.createElement("kbd")).textContent = i + 1;
    button.onclick = () => setMode(mode);
  });
}

async function showImages() {
  $("viewer").hidden = false;
  Object.assign($("canvas"), { width: data.width, height: data.height });
  planes.newLinear = await decode(data.new);
  planes.referenceLinear = await decode(data.reference);
  planes.difference = difference(planes.newLinear, planes.referenceLinear);
  planes.flip = heat(await pixels(data.flip));
  if (data.significance) planes.significance = heat(await pixels(data.significance));
  addButtons();
  $("exposure").value = data.exposure;
  setExposure(data.exposure);
  setMode(alone ? "new" : "swap");
  listen();
  layout();
  document.body.dataset.ready = "yes";
}

writeText();
if (data.new) showImages();
