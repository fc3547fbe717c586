"use strict";
// Decodes two images of high dynamic range and draws what can be made of them. No libraries.

const data = JSON.parse(document.getElementById("data").textContent);

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

// Black, violet, orange, pale yellow: dark is unremarkable.
const HEAT = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]];

function heat(image) {
  return sheet(image.width, image.height, (out) => {
    for (let i = 0; i < out.length; i += 4) {
      const x = (image.data[i] / 255) * (HEAT.length - 1);
      const k = Math.min(HEAT.length - 2, Math.floor(x));
      for (let c = 0; c < 3; c++) out[i + c] = HEAT[k][c] + (x - k) * (HEAT[k + 1][c] - HEAT[k][c]);
      out[i + 3] = 255;
    }
  });
}
