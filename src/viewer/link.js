// The connection to the program. It is made again whenever it breaks.

const FIRST_PAUSE = 250, LONGEST_PAUSE = 4000;

export class Link {
  #socket = null;
  #pause = FIRST_PAUSE;
  #timer = null;

  // `hear` gets each document, `tiles` each part of a frame, `state` how it stands: "open", "closed", or "full" where the
  // program is there but has no place for another page.
  constructor({ hear, tiles, state }) {
    this.hear = hear;
    this.tiles = tiles;
    this.state = state;
    this.#connect();
  }

  send(request) {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(request));
  }

  // Connects anew: the program then sends all that there is.
  again() {
    this.#socket.onopen = this.#socket.onmessage = this.#socket.onclose = null;
    this.#socket.close();
    this.#connect();
  }

  #connect() {
    clearTimeout(this.#timer);
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    let isOpened = false;
    socket.onopen = () => {
      isOpened = true;
      this.#pause = FIRST_PAUSE;
      this.state("open");
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.hear(JSON.parse(data));
      else this.tiles(data);
    };
    socket.onclose = async () => {
      const isFull = !isOpened && (await isThere());
      if (socket !== this.#socket) return;
      this.state(isFull ? "full" : "closed");
      this.#timer = setTimeout(() => this.#connect(), this.#pause);
      this.#pause = Math.min(this.#pause * 2, LONGEST_PAUSE);
    };
    this.#socket = socket;
  }
}

// Whether the program answers: browsers do not tell why a socket was refused.
function isThere() {
  return fetch(new URL("style.css", location.href)).then(({ ok }) => ok, () => false);
}

// The image of a name, or null where there is none, the program refused it, or the connection broke.
export async function imageOf(name) {
  try {
    const answer = await fetch(new URL(`image/${name}`, location.href));
    return answer.ok ? { data: await answer.arrayBuffer() } : { data: null, isRefused: true };
  } catch {
    return { data: null };
  }
}

// Parts of frames: u32 width, height, whether it is the last part, count; then for each tile u32 number and its halves.
const TILE = 64;

export function* tilesOf(buffer) {
  const view = new DataView(buffer);
  const [width, height, , count] = [0, 4, 8, 12].map((at) => view.getUint32(at, true));
  const columns = Math.ceil(width / TILE);
  let at = 16;
  for (let i = 0; i < count; i++) {
    const index = view.getUint32(at, true);
    const [x, y] = [(index % columns) * TILE, Math.floor(index / columns) * TILE];
    const [w, h] = [Math.min(TILE, width - x), Math.min(TILE, height - y)];
    at += 4;
    // A copy where the halves do not lie on even bytes; here they always do.
    yield { x, y, w, h, data: new Uint16Array(buffer, at, w * h * 3) };
    at += w * h * 6;
  }
}

export function headerOf(buffer) {
  const view = new DataView(buffer);
  return { width: view.getUint32(0, true), height: view.getUint32(4, true), isLast: view.getUint32(8, true) === 1 };
}
