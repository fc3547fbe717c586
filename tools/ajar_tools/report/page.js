"use strict";
// The viewer: decodes two images of high dynamic range, tones them, and draws what is asked for. No libraries.

const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const MODES = [
  ["swap", "Swap", "Hold the mouse button over the image, or the space bar, to see the reference."],
  ["wipe", "Wipe", "Move over the image: the new one is left of the line, the reference right of it."],
  ["new", "New", "The new image."],
  ["reference", "Reference", "The image that is right."],
  ["difference", "Difference", "Red where the new image is brighter, blue where it is darker; full colour at 50 %."],
  ["significance", "Beyond noise", "How far 8×8 blocks differ in standard errors; noise alone stays dark."],
  ["flip", "FLIP", "What a person would notice when the images are swapped."],
];
const state = { mode: "swap", held: false, wipe: 0.5, exposure: 0, zoom: 0 };
let planes = {};

function writeText() {
  const v = data.verdict;
  $("head").className = v.outcome;
  $("word").textContent = { pass: "SAME PICTURE", fail: "DIFFERENT PICTURE", cannot: "CANNOT COMPARE" }[v.outcome];
  $("reason").textContent = v.headline.replace(/^[A-Z ]+: /, "");
  $("command").textContent = data.command;
  $("numbers").textContent = JSON.stringify(v.gates, null, 1);
  for (const gate of v.gates) {
    const row = $("gates").tBodies[0].insertRow();
    for (const text of [gate.gate, gate.status, gate.message]) row.insertCell().textContent = text;
    row.cells[1].className = gate.status;
  }
  for (const line of v.exceptions) {
    const row = $("gates").tBodies[0].insertRow();
    for (const text of ["", "excused", line]) row.insertCell().textContent = text;
  }
  $("copy").onclick = () => navigator.clipboard && navigator.clipboard.writeText(data.command);
}

async function pixels(uri) {
  const image = new Image();
  image.src = uri;
  await image.decode();
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, image.width, image.height);
}

// Linear floats, three a pixel.
async function decode(image) {
  const [mantissa, exponent] = await Promise.all([pixels(image.mantissa), pixels(image.exponent)]);
  const linear = new Float32Array(data.width * data.height * 3);
  for (let i = 0, j = 0; i < mantissa.data.length; i += 4, j += 3) {
    const e = exponent.data[i];
    if (e === 0) continue;
    const scale = 2 ** (e - 136);
    for (let c = 0; c < 3; c++) linear[j + c] = (mantissa.data[i + c] + 0.5) * scale;
  }
  return linear;
}

function sheet(width, height, fill) {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  fill(image.data);
  context.putImageData(image, 0, 0);
  return canvas;
}

const SRGB = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const x = i / 4096;
  return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
});

function toned(linear) {
  const gain = 4096 * 2 ** state.exposure;
  return sheet(data.width, data.height, (out) => {
    for (let i = 0, j = 0; j < linear.length; i += 4, j += 3) {
      for (let c = 0; c < 3; c++) out[i + c] = SRGB[Math.min(4096, linear[j + c] * gain) | 0];
      out[i + 3] = 255;
    }
  });
}

function difference(a, b) {
  let mean = 0;
  for (const x of b) mean += x / b.length;
  return sheet(data.width, data.height, (out) => {
    for (let i = 0, j = 0; j < a.length; i += 4, j += 3) {
      const [x, y] = [a[j] + a[j + 1] + a[j + 2], b[j] + b[j + 1] + b[j + 2]];
      const d = Math.max(-1, Math.min(1, (2 * (x - y)) / (y + 0.3 * mean + 1e-30)));
      const fade = 255 * (1 - Math.abs(d));
      out.set(d > 0 ? [255, fade, fade, 255] : [fade, fade, 255, 255], i);
    }
  });
}

// Black, violet, orange, white: dark is unremarkable.
function heat(image) {
  const stops = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]];
  return sheet(image.width, image.height, (out) => {
    for (let i = 0; i < out.length; i += 4) {
      const x = (image.data[i] / 255) * (stops.length - 1);
      const k = Math.min(stops.length - 2, Math.floor(x));
      for (let c = 0; c < 3; c++) out[i + c] = stops[k][c] + (x - k) * (stops[k + 1][c] - stops[k][c]);
      out[i + 3] = 255;
    }
  });
}

function draw() {
  const context = $("canvas").getContext("2d");
  const { width, height } = data;
  const show = (canvas, w = width, h = height) => {
    context.imageSmoothingEnabled = false;
    context.drawImage(canvas, 0, 0, w, h);
  };
  if (state.mode === "swap") show(state.held ? planes.reference : planes.new);
  else if (state.mode === "wipe") {
    const x = Math.round(state.wipe * width);
    show(planes.reference);
    if (x > 0) context.drawImage(planes.new, 0, 0, x, height, 0, 0, x, height);
    context.fillStyle = "#ffd60a";
    context.fillRect(x, 0, Math.max(1, width / 1000), height);
  } else if (state.mode === "significance") {
    // The last blocks may reach beyond the image.
    const side = 8 / data.factor;
    show(planes.significance, planes.significance.width * side, planes.significance.height * side);
  } else if (state.mode === "flip") {
    const side = data.flip_factor / data.factor;
    context.fillRect(0, 0, width, height);
    show(planes.flip, planes.flip.width * side, planes.flip.height * side);
  } else show(planes[state.mode]);
  const which = { swap: state.held ? "reference" : "new" }[state.mode] || state.mode;
  $("canvas").dataset.shown = which;
}

function layout() {
  const { width, height, block, factor, origin } = data;
  const fit = Math.min($("stage").clientWidth / width, (0.72 * innerHeight) / height);
  const zoom = state.zoom || (fit > 1 ? Math.floor(fit) : fit);
  Object.assign($("frame").style, { width: `${width * zoom}px`, height: `${height * zoom}px` });
  $("block").hidden = !block;
  if (!block) return;
  const [x0, y0, x1, y1] = block.map((v, i) => ((v - origin[i % 2]) / factor) * zoom);
  const style = { left: `${x0}px`, top: `${y0}px`, width: `${x1 - x0}px`, height: `${y1 - y0}px` };
  Object.assign($("block").style, style);
}

function setMode(mode) {
  state.mode = mode;
  for (const button of $("modes").children) button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
  const note = data.factor > 1 ? ` Each pixel here is the mean of ${data.factor}×${data.factor}.` : "";
  $("hint").textContent = MODES.find(([name]) => name === mode)[2] + note;
  draw();
}

function setExposure(stops) {
  state.exposure = stops;
  $("stops").textContent = `${stops >= 0 ? "+" : "−"}${Math.abs(stops).toFixed(1)} EV`;
  planes.new = toned(planes.newLinear);
  planes.reference = toned(planes.referenceLinear);
  draw();
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
    `pixel ${place}   new ${text(planes.newLinear)}   reference ${text(planes.referenceLinear)}`;
}

function listen() {
  const hold = (held) => {
    state.held = held;
    draw();
  };
  $("frame").onpointermove = (event) => {
    const box = $("frame").getBoundingClientRect();
    state.wipe = (event.clientX - box.left) / box.width;
    if (state.mode === "wipe") draw();
    readPixel(event);
  };
  $("frame").onpointerdown = () => hold(true);
  addEventListener("pointerup", () => hold(false));
  addEventListener("keydown", (event) => {
    if (event.target.matches("select")) return;
    const button = $("modes").children[Number(event.key) - 1];
    if (button) setMode(button.dataset.mode);
    if (event.key === " " && !event.repeat) {
      event.preventDefault();
      hold(true);
    }
  });
  addEventListener("keyup", (event) => event.key === " " && hold(false));
  $("exposure").oninput = () => setExposure(Number($("exposure").value));
  $("zoom").onchange = () => {
    state.zoom = Number($("zoom").value);
    layout();
  };
  addEventListener("resize", layout);
}

async function showImages() {
  $("viewer").hidden = false;
  Object.assign($("canvas"), { width: data.width, height: data.height });
  planes.newLinear = await decode(data.new);
  planes.referenceLinear = await decode(data.reference);
  planes.difference = difference(planes.newLinear, planes.referenceLinear);
  planes.flip = heat(await pixels(data.flip));
  if (data.significance) planes.significance = heat(await pixels(data.significance));
  const modes = MODES.filter(([mode]) => mode !== "significance" || data.significance);
  modes.forEach(([mode, name], i) => {
    const button = $("modes").appendChild(document.createElement("button"));
    button.dataset.mode = mode;
    button.textContent = name;
    button.appendChild(document.createElement("kbd")).textContent = i + 1;
    button.onclick = () => setMode(mode);
  });
  $("exposure").value = data.exposure;
  setExposure(data.exposure);
  setMode("swap");
  listen();
  layout();
  document.body.dataset.ready = "yes";
}

writeText();
if (data.new) showImages();
