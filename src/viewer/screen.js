// The canvas: images as float textures, tone mapped as they are drawn.

import { FRAGMENT, VERTEX } from "./shader.js";
import { headerOf, tilesOf } from "./link.js";

export const CURVES = ["agx", "aces", "neutral", "srgb", "false"];
export const MODES = ["now", "wipe", "before", "difference"];

// An image on its way to the screen: parts of a frame wait until it is whole, so that none is seen half.
class Picture {
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

export class Screen {
  // How it is shown. `size` is that of the full frame; `zoom` is pixels of the screen a pixel, `center` what is in the middle.
  view = { exposure: 0, balance: 0, curve: "agx", mode: "now", layer: false, wipe: 0.5, region: null, zoom: 1, center: [0, 0], size: [1, 1] };
  frames = 0;
  #gl;
  #program;
  #drawing = false;

  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This page needs WebGL 2.");
    this.#gl = gl;
    this.now = new Picture(gl);
    this.before = new Picture(gl);
    this.layer = new Picture(gl);
    this.#program = link(gl);
    const corners = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, corners);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    new ResizeObserver(() => this.draw()).observe(canvas);
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

  // Where pixel (0, 0) of the frame is on the canvas, in CSS pixels.
  origin() {
    const { zoom, center } = this.view;
    return [this.canvas.clientWidth / 2 - center[0] * zoom, this.canvas.clientHeight / 2 - center[1] * zoom];
  }

  // The pixel of the frame at a point of the canvas.
  pixelAt(x, y) {
    const [ox, oy] = this.origin();
    return [(x - ox) / this.view.zoom, (y - oy) / this.view.zoom];
  }

  fit() {
    const [w, h] = this.view.size;
    this.view.zoom = Math.min(this.canvas.clientWidth / w, this.canvas.clientHeight / h) || 1;
    this.view.center = [w / 2, h / 2];
    this.draw();
  }

  zoomAt(x, y, factor) {
    const [px, py] = this.pixelAt(x, y);
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.05), 64);
    const { zoom } = this.view;
    this.view.center = [px - (x - this.canvas.clientWidth / 2) / zoom, py - (y - this.canvas.clientHeight / 2) / zoom];
    this.draw();
  }

  #paint() {
    const gl = this.#gl, canvas = this.canvas, view = this.view, scale = devicePixelRatio;
    const size = [Math.round(canvas.clientWidth * scale), Math.round(canvas.clientHeight * scale)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    gl.viewport(0, 0, ...size);
    const at = (name) => gl.getUniformLocation(this.#program, name);
    const shown = view.layer ? this.layer : this.now;
    const filter = view.zoom * scale >= 2 && shown.width === view.size[0] ? gl.NEAREST : gl.LINEAR;
    [shown, this.before].forEach(({ texture }, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(at("now"), 0);
    gl.uniform1i(at("before"), 1);
    gl.uniform2fv(at("origin"), this.origin().map((x) => x * scale));
    gl.uniform2fv(at("extent"), view.size.map((n) => n * view.zoom * scale));
    gl.uniform2fv(at("canvas"), size);
    const warm = view.balance / 2;
    gl.uniform3fv(at("gain"), [warm, 0, -warm].map((stops) => 2 ** (view.exposure + stops)));
    gl.uniform1i(at("curve"), CURVES.indexOf(view.curve));
    gl.uniform1i(at("isCode"), view.layer);
    gl.uniform1i(at("mode"), this.before.width && !view.layer ? MODES.indexOf(view.mode) : 0);
    gl.uniform1f(at("wipe"), view.wipe * size[0]);
    const [w, h] = view.size;
    const [x0, y0, x1, y1] = view.region ?? [0, 0, w, h];
    gl.uniform4f(at("region"), x0 / w, y0 / h, x1 / w, y1 / h);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    canvas.dataset.frames = this.frames;
    canvas.dataset.zoom = view.zoom;
    canvas.dataset.width = this.now.width;
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
