// The canvas: images as float textures, tone mapped as they are drawn.

import { Picture } from "./picture.js";
import { FRAGMENT, VERTEX } from "./shader.js";

export const CURVES = ["agx", "aces", "neutral", "srgb", "false"];
export const MODES = ["now", "wipe", "before", "difference"];

// From this many pixels of the screen a pixel, pixels are squares; a little less than 1, for 1 may come out so.
const SQUARES = 0.9999;

export class Screen {
  // How it is shown. `size` is that of the full frame; `zoom` is CSS pixels a pixel, `center` what is in the middle; `peek`
  // is whether an image of before is shown in place of all else, `layer` whether a view that is no light is.
  view = {
    exposure: 0, balance: 0, curve: "agx", mode: "now", peek: false, layer: false, wipe: 0.5, region: null,
    zoom: 1, center: [0, 0], size: [1, 1],
  };
  frames = 0;
  #gl;
  #program;
  #drawing = false;
  #isFitted = true;

  // `lost` is called when the graphics card has dropped all images, and they can be taken in again.
  constructor(canvas, lost) {
    this.canvas = canvas;
    this.#gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
    if (!this.#gl) throw new Error("This page needs WebGL 2, which this browser does not offer or has turned off.");
    this.#build();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.#build();
      lost();
    });
    new ResizeObserver(() => (this.#isFitted ? this.fit() : this.draw())).observe(canvas);
  }

  #build() {
    const gl = this.#gl;
    for (const name of ["now", "before", "peeked", "layer"]) this[name] = new Picture(gl);
    this.#program = link(gl);
    const corners = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, corners);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  }

  // Takes in a part of the live frame.
  tiles(buffer) {
    if (this.now.add(buffer)) {
      this.frames += 1;
      this.draw();
    }
  }

  draw() {
    if (this.#drawing) return;
    this.#drawing = true;
    requestAnimationFrame(() => {
      this.#drawing = false;
      this.#paint();
    });
  }

  // Where pixel (0, 0) of the frame is on the canvas, in CSS pixels: a whole pixel of the screen.
  origin() {
    const { zoom, center } = this.view, scale = devicePixelRatio;
    const middle = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
    return middle.map((half, i) => Math.round((half - center[i] * zoom) * scale) / scale);
  }

  // The pixel of the frame at a point of the canvas.
  pixelAt(x, y) {
    const [ox, oy] = this.origin();
    return [(x - ox) / this.view.zoom, (y - oy) / this.view.zoom];
  }

  // Shows all of it, and goes on doing so when the canvas gets another size.
  fit() {
    const [w, h] = this.view.size;
    this.#isFitted = true;
    this.view.zoom = Math.min(this.canvas.clientWidth / w, this.canvas.clientHeight / h) || 1;
    this.view.center = [w / 2, h / 2];
    this.draw();
  }

  // A pixel for a pixel of the screen; what is in the middle stays there.
  actual() {
    this.#isFitted = false;
    this.view.zoom = 1 / devicePixelRatio;
    this.draw();
  }

  // What is at that point of the canvas stays there.
  zoomAt(x, y, factor) {
    const [px, py] = this.pixelAt(x, y);
    const zoom = Math.min(Math.max(this.view.zoom * factor, 0.05), 64);
    this.#isFitted = false;
    this.view.zoom = zoom;
    this.view.center = [px - (x - this.canvas.clientWidth / 2) / zoom, py - (y - this.canvas.clientHeight / 2) / zoom];
    this.draw();
  }

  // Moves the image by so many CSS pixels.
  pan(dx, dy) {
    const { zoom, center } = this.view;
    this.#isFitted = false;
    this.view.center = [center[0] - dx / zoom, center[1] - dy / zoom];
    this.draw();
  }

  // Gives `done` a PNG of what is shown: the whole image, a pixel for a pixel.
  png(done) {
    const { size, zoom, wipe } = this.view;
    const edge = (wipe * this.canvas.clientWidth - this.origin()[0]) / zoom;
    this.#render(size, [0, 0], 1, edge);
    // It takes what is there now, before the screen shows it.
    this.canvas.toBlob(done);
    this.#paint();
  }

  #paint() {
    const canvas = this.canvas, view = this.view, scale = devicePixelRatio;
    const size = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * scale));
    this.#render(size, this.origin().map((x) => x * scale), view.zoom * scale, view.wipe * size[0]);
    canvas.dataset.frames = this.frames;
    canvas.dataset.zoom = view.zoom;
    canvas.dataset.width = this.now.width;
  }

  // Draws on a canvas of this size; `origin`, `zoom` and the edge of the wipe are in its pixels.
  #render(size, origin, zoom, wipe) {
    const gl = this.#gl, canvas = this.canvas, view = this.view;
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    gl.viewport(0, 0, ...size);
    const at = (name) => gl.getUniformLocation(this.#program, name);
    const isCode = view.layer && !view.peek;
    const shown = view.peek ? this.peeked : isCode ? this.layer : this.now;
    const filter = zoom >= SQUARES && shown.width === view.size[0] ? gl.NEAREST : gl.LINEAR;
    [shown, this.before].forEach(({ texture }, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(at("now"), 0);
    gl.uniform1i(at("before"), 1);
    gl.uniform2fv(at("origin"), origin);
    gl.uniform2fv(at("extent"), view.size.map((n) => n * zoom));
    gl.uniform2fv(at("canvas"), size);
    const warm = view.balance / 2;
    gl.uniform3fv(at("gain"), [warm, 0, -warm].map((stops) => 2 ** (view.exposure + stops)));
    gl.uniform1i(at("curve"), CURVES.indexOf(view.curve));
    gl.uniform1i(at("isCode"), isCode);
    gl.uniform1i(at("mode"), this.before.width && shown === this.now ? MODES.indexOf(view.mode) : 0);
    gl.uniform1f(at("wipe"), wipe);
    const [w, h] = view.size;
    const [x0, y0, x1, y1] = view.region ?? [0, 0, w, h];
    gl.uniform4f(at("region"), x0 / w, y0 / h, x1 / w, y1 / h);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}

function link(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, "corner");
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  return program;
}
