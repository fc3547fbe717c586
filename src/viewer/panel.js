// Values of materials and lights that can be changed.

const $ = (id) => document.getElementById(id);

const PAUSE = 500;

// Scene files know these keys; beyond the range of a slider, numbers can be typed.
const NUMBERS = {
  roughness: [0, 1], metallic: [0, 1], specular: [0, 1], ior: [1, 3], transmission: [0, 1],
  coat: [0, 1], coat_roughness: [0, 1], opacity: [0, 1],
};
// Degrees; other numbers of lights are lengths in metres.
const ANGLES = { inner: [0, 90], outer: [0, 90], angle: [0, 30] };
const COLORS = { base_color: "srgb", emission: "light" };

const encode = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const decode = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
const hex = (rgb) => "#" + rgb.map((x) => Math.round(encode(Math.min(Math.max(x, 0), 1)) * 255).toString(16).padStart(2, "0")).join("");
const rgb = (text) => [1, 3, 5].map((at) => Number(decode(parseInt(text.slice(at, at + 2), 16) / 255).toFixed(5)));
const short = (x) => Number(Number(x).toPrecision(5));

export class Panel {
  #scene = null;
  #touched = -Infinity;
  #later = null;

  constructor(send) {
    this.send = send;
    for (const kind of ["material", "light"]) $(kind + "s").onchange = () => this.#show(kind);
    $("panel").addEventListener("input", () => (this.#touched = performance.now()));
    $("cameras").onchange = (event) => send({ do: "through", camera: event.target.value });
  }

  learn(scene) {
    this.#scene = scene;
    fill($("materials"), scene.materials.map(({ name }) => name));
    fill($("lights"), scene.lights.map(({ name }) => name));
    fill($("cameras"), scene.cameras);
    $("cameras").value = scene.camera.name;
    this.#refresh();
  }

  // A control that is being used must not change under the pointer: then later.
  #refresh() {
    clearTimeout(this.#later);
    if (this.#isUsed()) this.#later = setTimeout(() => this.#refresh(), PAUSE);
    else ["material", "light"].forEach((kind) => this.#show(kind));
  }

  #isUsed() {
    const used = document.activeElement;
    if (!document.hasFocus() || !$("panel").contains(used)) return false;
    if (["number", "color"].includes(used.type)) return true;
    return used.type === "range" && (used.matches(":active") || performance.now() - this.#touched < 2 * PAUSE);
  }

  // Shows the material of this name.
  choose(material) {
    if (!this.#scene?.materials.some(({ name }) => name === material)) return;
    $("materials").value = material;
    this.#show("material");
  }

  #show(kind) {
    const found = this.#scene[kind + "s"].find(({ name }) => name === $(kind + "s").value);
    const rows = !found ? [] : kind === "material" ? this.#material(found) : this.#light(found);
    $(kind).replaceChildren(...rows);
  }

  #material(material) {
    const set = (key) => (value) => this.send({ do: "set", table: "material", name: material.name, key, value });
    const colors = Object.keys(COLORS).map((key) => colorRow(key, material[key], set(key), COLORS[key] === "light"));
    const numbers = Object.entries(NUMBERS).map(([key, range]) => numberRow(key, material[key], range, set(key)));
    return [...colors.slice(0, 1), ...numbers, ...colors.slice(1)];
  }

  #light({ name, table, key, strength, scale, color, shape }) {
    const set = (key) => (value) => this.send({ do: "set", table, name, key, value });
    const ofAsset = table === "node";
    const scaled = ofAsset ? ["light_scale", { value: scale ?? 1 }, [0, 4]] : [key, { value: strength }, [0, Math.max(2 * strength, 1)]];
    // Those of an asset are its own.
    const numbers = Object.entries(ofAsset ? {} : shape).map(([key, value]) => numberRow(key, { value }, ANGLES[key] ?? [value / 50, 2 * value], set(key)));
    return [numberRow(...scaled, set(scaled[0])), ...numbers, colorRow(ofAsset ? "light_color" : "color", { value: color }, set(ofAsset ? "light_color" : "color"))];
  }
}

function fill(select, names) {
  const before = select.value;
  if (select.dataset.names !== JSON.stringify(names)) {
    select.replaceChildren(...names.map((name) => new Option(name, name)));
    select.dataset.names = JSON.stringify(names);
    if (names.includes(before)) select.value = before;
  }
  select.closest("section").hidden = names.length === 0;
}

function row(key, textured) {
  const label = document.createElement("label");
  const text = document.createElement("span");
  text.textContent = key.replaceAll("_", " ");
  if (textured) {
    text.className = "mapped";
    text.title = "multiplied by a texture, which a change takes away";
    text.textContent += " ×";
  }
  label.append(text);
  return label;
}

function input(type, values, change) {
  const made = Object.assign(document.createElement("input"), { type, ...values });
  made.oninput = () => change(made);
  return made;
}

function numberRow(key, { value, textured }, [min, max], set) {
  const label = row(key, textured);
  const send = (from, to) => {
    const number = short(from.value);
    if (!Number.isFinite(number) || from.value === "") return;
    to.value = number;
    set(number);
  };
  const slider = input("range", { min, max, step: (max - min) / 200, value }, () => send(slider, exact));
  const exact = input("number", { step: "any", value: short(value) }, () => send(exact, slider));
  slider.dataset.key = exact.dataset.key = key;
  label.append(slider, exact);
  return label;
}

// `isLight` colours may be brighter than 1: a colour and what it is multiplied by.
function colorRow(key, { value, textured }, set, isLight = false) {
  const label = row(key, textured);
  const peak = isLight ? Math.max(...value, 0) || 1 : Math.max(1, ...value);
  const send = () => {
    // A light that was dark would stay so in any colour.
    if (isLight && Number(scale.value) === 0) scale.value = 1;
    set(rgb(picker.value).map((x) => short(x * (isLight ? Number(scale.value) : 1))));
  };
  const picker = input("color", { value: hex(value.map((x) => x / peak)) }, send);
  const scale = input("number", { step: "any", min: 0, value: short(Math.max(...value, 0)) }, send);
  picker.dataset.key = key;
  label.append(picker);
  if (isLight) label.append(scale);
  return label;
}
