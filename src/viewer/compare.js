// Images of before, one a change: looked at while the pointer is on them, or compared with the image.

import { imageOf } from "./link.js";
import { samples as inWords, say } from "./status.js";

const $ = (id) => document.getElementById(id);

const WAYS = [["wipe", "wipe"], ["swap", "before"], ["difference", "difference"]];

export class Compare {
  #screen;
  #layers;
  #snapshots = [];
  // Numbers of images: the one that is compared with, and the one that the pointer is on.
  #chosen = null;
  #hovered = null;
  #isStale = false;

  constructor(screen, layers) {
    this.#screen = screen;
    this.#layers = layers;
    for (const [id, mode] of WAYS) $(id).onclick = () => this.toggle(mode);
    const list = $("snapshots");
    list.addEventListener("pointerover", ({ target, pointerType }) => {
      if (pointerType === "mouse") this.#peek(target.closest("button")?.dataset.image ?? null);
    });
    list.addEventListener("pointerleave", () => this.#peek(null));
  }

  // What there is, the oldest first.
  learn(snapshots) {
    const isKnown = JSON.stringify(snapshots) === JSON.stringify(this.#snapshots);
    this.#snapshots = snapshots;
    if (!isKnown) this.#list();
    if (!this.#isStale) return;
    this.#isStale = false;
    const isThere = snapshots.some(({ image }) => image === this.#chosen);
    if (isThere) this.#choose(this.#chosen);
    else this.#drop();
  }

  // The images that are here may not be those of the program that speaks next.
  forget() {
    this.#isStale = true;
    this.#peek(null);
  }

  // Compares in this way, or no longer.
  async toggle(mode) {
    const next = this.#screen.view.mode === mode ? "now" : mode;
    if (next !== "now" && this.#chosen === null) {
      const last = this.#snapshots.at(-1);
      if (!last || !(await this.#choose(last.image))) return;
    }
    this.#set(next);
  }

  #set(mode) {
    const { view } = this.#screen;
    if (mode !== "now") this.#layers.choose("");
    view.mode = mode;
    for (const [id, name] of WAYS) $(id).classList.toggle("on", mode === name);
    $("wiper").hidden = mode !== "wipe";
    $("wiper").style.left = `${view.wipe * 100}%`;
    document.body.dataset.mode = mode;
    this.#screen.draw();
  }

  #list() {
    const buttons = this.#snapshots.toReversed().map(({ image, changed, samples }) => {
      const button = document.createElement("button");
      const [name, size] = [`${image}  ${changed.join(", ") || "first image"}`, inWords(samples)];
      button.append(span(name), span(size, "faint"));
      button.title = `${name}, ${size}`;
      button.dataset.image = image;
      button.onclick = async () => {
        if ((await this.#choose(image)) && this.#screen.view.mode === "now") this.#set("wipe");
      };
      return button;
    });
    $("snapshots").replaceChildren(...(buttons.length ? buttons : [span("Images of before appear here, one a change.", "faint")]));
    for (const [id] of WAYS) $(id).disabled = buttons.length === 0;
    this.#mark();
  }

  #mark() {
    for (const button of $("snapshots").children) button.classList.toggle("on", button.dataset.image === String(this.#chosen));
  }

  // Compares with this one from now on; returns whether it could be had.
  async #choose(image) {
    this.#chosen = image;
    this.#mark();
    const data = await fetched(image);
    if (image !== this.#chosen) return false;
    if (data) this.#screen.before.add(data);
    else this.#drop();
    // Who chooses wants to see the comparison, though the pointer still is on the button.
    this.#peek(null);
    this.#screen.draw();
    return data !== null;
  }

  #drop() {
    this.#chosen = null;
    this.#mark();
    this.#set("now");
  }

  async #peek(image) {
    if (image === this.#hovered) return;
    this.#hovered = image;
    const data = image && (await fetched(image));
    if (image !== this.#hovered) return;
    if (data) this.#screen.peeked.add(data);
    this.#screen.view.peek = Boolean(data);
    document.body.dataset.peek = data ? image : "";
    this.#screen.draw();
  }
}

// The image of a number, or null.
async function fetched(image) {
  const { data } = await imageOf(image);
  if (!data) say("That image is no longer kept.");
  return data;
}

function span(text, kind = "") {
  return Object.assign(document.createElement("span"), { textContent: text, className: kind });
}
