// Moving the camera with the pointer: about its target, sideways, and nearer.

const PAUSE = 60;

const add = (a, b, s = 1) => a.map((x, i) => x + s * b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

// `v` turned about `axis`, a unit vector (Rodrigues).
function turned(v, axis, angle) {
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  const along = dot(v, axis) * (1 - c);
  const side = cross(axis, v);
  return v.map((x, i) => x * c + side[i] * s + axis[i] * along);
}

// Whether two cameras stand in one place and look the same way, whatever point each turns about. Scene files round to a
// hundredth of a millimetre.
function isSameView(a, b) {
  const way = ({ position, target }) => unit(add(target, position, -1));
  const apart = (v, w) => Math.hypot(...add(v, w, -1));
  return apart(a.position, b.position) < 2e-5 && apart(way(a), way(b)) < 1e-4 && apart(unit(a.up), unit(b.up)) < 1e-4;
}

export class Camera {
  #place = null;
  #said = null;
  #touched = -Infinity;
  #timer = null;

  constructor(send) {
    this.send = send;
  }

  // What the program says; while it is being moved, what the pointer says counts.
  learn({ name, position, target, up, yfov, half_height }) {
    this.#said = { name, position, target, up, yfov, half_height };
    this.#settle();
  }

  // What the program says next counts, for somebody asked for another camera.
  follow() {
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#touched = -Infinity;
  }

  #settle() {
    if (performance.now() - this.#touched <= 1500) return;
    // Where the pointer left it, it goes on turning about the same point.
    const stays = this.#place && isSameView(this.#place, this.#said);
    this.#place = stays ? { ...this.#said, target: this.#place.target } : this.#said;
  }

  // As scene files say it.
  toml() {
    if (this.#said) this.#settle();
    if (!this.#place) return "";
    const { name, position, target, up, yfov, half_height } = this.#place;
    const keys = { name, position, target, up, yfov, half_height };
    // A hundredth of a millimetre is enough, and reads better.
    const said = (value) => (typeof value === "string" ? JSON.stringify(value) : String(Number(value.toFixed(5))));
    const line = ([key, value]) => `${key} = ${Array.isArray(value) ? `[${value.map(said).join(", ")}]` : said(value)}\n`;
    return "[[camera]]\n" + Object.entries(keys).filter(([, value]) => value).map(line).join("");
  }

  // `dx` and `dy` in parts of the canvas's height.
  orbit(dx, dy) {
    this.#move(({ position, target, up }) => {
      const away = add(position, target, -1);
      const right = unit(cross(up, away));
      const pole = Math.acos(Math.min(Math.max(dot(unit(away), [0, 1, 0]), -1), 1));
      const pitch = Math.min(Math.max(-dy * 3, 0.02 - pole), Math.PI - 0.02 - pole);
      const swing = (v) => turned(turned(v, right, pitch), [0, 1, 0], -dx * 3);
      return { position: add(target, swing(away)), target, up: swing(up) };
    });
  }

  // `dx` and `dy` in parts of the image's height.
  pan(dx, dy) {
    this.#move(({ position, target, up, yfov, half_height }) => {
      const away = add(position, target, -1);
      const reach = 2 * (half_height ?? Math.hypot(...away) * Math.tan((yfov * Math.PI) / 360));
      const right = unit(cross(up, away)), above = unit(cross(away, right));
      const by = add(right.map((x) => -x * dx * reach), above, dy * reach);
      return { position: add(position, by), target: add(target, by), up };
    });
  }

  dolly(factor) {
    // To an orthographic camera nothing is larger from near by: it sees less.
    this.#move(({ position, target, half_height }) =>
      half_height ? { half_height: half_height * factor } : { position: add(target, add(position, target, -1), factor) });
  }

  #move(how) {
    if (this.#said) this.#settle();
    if (!this.#place) return;
    this.#place = { ...this.#place, ...how(this.#place) };
    this.#touched = performance.now();
    // The last place always gets there; those between need not.
    this.#timer ??= setTimeout(() => {
      this.#timer = null;
      const { position, target, up, half_height } = this.#place;
      this.send({ do: "camera", position, target, up, half_height });
    }, PAUSE);
  }
}
