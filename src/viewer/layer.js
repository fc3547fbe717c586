// What is shown: the image, or a view of what the camera sees first, which the program makes when it is asked.

import { imageOf } from "./link.js";
import { say } from "./status.js";

const $ = (id) => document.getElementById(id);

// The error changes with every round; the others are of one image.
const CHANGES = "variance", PAUSE = 2000;

export class Layers {
  name = "";
  #screen;
  #has = "";
  #at = 0;
  #asks = false;
  #state = { image: 0 };

  constructor(screen) {
    this.#screen = screen;
    $("layer").onchange = () => this.choose($("layer").value);
  }

  choose(name) {
    this.name = $("layer").value = name;
    this.#has = "";
    this.#at = 0;
    if (!name) this.#show(false);
    document.body.dataset.layer = name;
    this.follow(this.#state);
  }

  // The program may be another one.
  forget() {
    this.#has = "";
  }

  next() {
    const { options, selectedIndex } = $("layer");
    this.choose(options[(selectedIndex + 1) % options.length].value);
  }

  // Sees to it that the view is that of the image which is rendered.
  async follow(state) {
    this.#state = state;
    const { image, rounds, phase } = state;
    const round = this.name === CHANGES ? rounds : 0;
    const wanted = `${this.name} ${image} ${round}`;
    const isSoon = this.name === CHANGES && phase === "rendering" && performance.now() - this.#at < PAUSE;
    if (!this.name || image === 0 || wanted === this.#has || this.#asks || isSoon) return;
    this.#asks = true;
    const name = this.name;
    const { data, isRefused } = await imageOf(name);
    this.#asks = false;
    if (data && name === this.name) {
      this.#screen.layer.add(data);
      this.#has = wanted;
      this.#at = performance.now();
      this.#show(true);
    }
    // What was said meanwhile; a view that could not be made is asked for again when there is more to see.
    if (data) this.follow(this.#state);
    else if (isRefused) say("The view could not be made.");
  }

  #show(isShown) {
    this.#screen.view.layer = isShown && this.name !== "";
    document.body.dataset.shown = isShown ? this.#has : "";
    this.#screen.draw();
  }
}
