// An image on its way to the screen: parts of a frame wait until it is whole, so that none is seen half.

import { headerOf, tilesOf } from "./link.js";

export class Picture {
  #gl;
  #waiting = [];

  constructor(gl) {
    this.#gl = gl;
    this.texture = gl.createTexture();
    this.width = this.height = 0;
  }

  // Takes a part in; returns whether the frame is whole.
  add(buffer) {
    this.#waiting.push(buffer);
    const { width, height, isLast } = headerOf(buffer);
    if (!isLast) return false;
    this.#bind(width, height);
    const gl = this.#gl;
    for (const part of this.#waiting) {
      for (const { x, y, w, h, data } of tilesOf(part)) {
        gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, w, h, gl.RGB, gl.HALF_FLOAT, data);
      }
    }
    this.#waiting = [];
    return true;
  }

  // What came of a frame before the connection broke is of no use.
  forget() {
    this.#waiting = [];
  }

  #bind(width, height) {
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (width === this.width && height === this.height) return;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, width, height, 0, gl.RGB, gl.HALF_FLOAT, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    [this.width, this.height] = [width, height];
  }
}
