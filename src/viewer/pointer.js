// What the pointer does over the image.

const $ = (id) => document.getElementById(id);

// A click moves less than this many pixels.
const CLICK = 4;
// Milliseconds between two looks at a pixel.
const PAUSE = 80;

export function addPointer({ screen, camera, send }) {
  const canvas = $("canvas"), view = screen.view;
  let tool = "look", drag = null, clicked = null;
  // Where the pointer is over the image, and what asks in a moment what is there.
  let spot = null, timer = null;
  // Where each finger is; two of them zoom and move.
  const fingers = new Map();

  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const choose = (name) => {
    tool = tool === name ? "look" : name;
    canvas.dataset.tool = tool;
    for (const it of ["camera", "region"]) $(`${it}-tool`).classList.toggle("on", tool === it);
  };
  const ask = (isChosen) => {
    const [px, py] = spot ? screen.pixelAt(...spot).map(Math.floor) : [-1, -1];
    const isInside = px >= 0 && py >= 0 && px < view.size[0] && py < view.size[1];
    if (!isInside) $("probe").hidden = true;
    else send({ do: "probe", x: px, y: py });
    if (isChosen) clicked = `${px},${py}`;
  };
  const look = () => {
    timer ??= setTimeout(() => {
      timer = null;
      ask(false);
    }, PAUSE);
  };
  // The scene goes with the pointer.
  const pan = (dx, dy) => {
    const height = view.zoom * view.size[1];
    camera.pan(dx / height, dy / height);
  };
  // What lies between two fingers: its middle and how far they are apart.
  const span = () => {
    const [[ax, ay], [bx, by]] = [...fingers.values()];
    return { middle: [(ax + bx) / 2, (ay + by) / 2], apart: Math.hypot(ax - bx, ay - by) || 1 };
  };
  const pinch = (event) => {
    const before = span();
    fingers.set(event.pointerId, at(event));
    const { middle, apart } = span();
    const [dx, dy] = [middle[0] - before.middle[0], middle[1] - before.middle[1]];
    if (tool === "camera") {
      pan(dx, dy);
      camera.dolly(before.apart / apart);
      return;
    }
    screen.pan(dx, dy);
    screen.zoomAt(...middle, apart / before.apart);
  };
  const begin = (event) => {
    if (event.pointerType === "touch") fingers.set(event.pointerId, at(event));
    if (fingers.size > 1) {
      drag = null;
      $("marquee").hidden = true;
      return;
    }
    const isCamera = tool === "camera" || event.altKey;
    const kind = tool === "region" && !event.altKey ? "region" : !isCamera ? "move"
      : event.button === 2 ? "dolly" : event.button === 1 || event.shiftKey ? "pan" : "orbit";
    drag = { kind, start: at(event), last: at(event), moved: false };
    canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
    canvas.focus();
  };
  const move = (event) => {
    if (fingers.size === 2 && fingers.has(event.pointerId)) return pinch(event);
    const [x, y] = (spot = at(event));
    // It does not cover what is looked at.
    $("probe").classList.toggle("aside", x < canvas.clientWidth / 2 && y > canvas.clientHeight / 2);
    if (!drag) return look();
    const [dx, dy] = [x - drag.last[0], y - drag.last[1]];
    drag.moved ||= Math.hypot(x - drag.start[0], y - drag.start[1]) >= CLICK;
    if (!drag.moved) return;
    drag.last = [x, y];
    const height = canvas.clientHeight;
    if (drag.kind === "move") screen.pan(dx, dy);
    else if (drag.kind === "orbit") camera.orbit(dx / height, dy / height);
    else if (drag.kind === "pan") pan(dx, dy);
    else if (drag.kind === "dolly") camera.dolly(Math.exp((dy * 2) / height));
    else marquee(drag.start, [x, y]);
  };
  const end = (event) => {
    fingers.delete(event.pointerId);
    if (!drag) return;
    const { kind, start, moved } = drag;
    drag = null;
    $("marquee").hidden = true;
    spot = at(event);
    if (!moved && kind !== "region") ask(true);
    if (kind === "region" && moved) {
      const [a, b] = [screen.pixelAt(...start), screen.pixelAt(...at(event))];
      const low = (i) => Math.max(0, Math.floor(Math.min(a[i], b[i])));
      const high = (i) => Math.max(0, Math.min(view.size[i], Math.ceil(Math.max(a[i], b[i]))));
      send({ do: "region", pixels: [low(0), low(1), high(0), high(1)] });
      choose("look");
    }
  };

  canvas.addEventListener("pointerdown", begin);
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", (event) => {
    fingers.delete(event.pointerId);
    drag = null;
    $("marquee").hidden = true;
  });
  canvas.addEventListener("pointerleave", ({ pointerType }) => {
    // A finger that is lifted leaves too, and what it touched is still of interest.
    if (pointerType === "touch") return;
    spot = null;
    $("probe").hidden = true;
  });
  $("probe").addEventListener("pointerdown", () => {
    spot = null;
    $("probe").hidden = true;
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY / (event.deltaMode ? 8 : 400));
    if (tool === "camera" || event.altKey) camera.dolly(1 / factor);
    else screen.zoomAt(...at(event), factor);
    look();
  }, { passive: false });

  const wiper = $("wiper");
  wiper.addEventListener("pointerdown", (event) => wiper.setPointerCapture(event.pointerId));
  wiper.addEventListener("pointermove", (event) => {
    if (!wiper.hasPointerCapture(event.pointerId)) return;
    view.wipe = Math.min(Math.max(at(event)[0] / canvas.clientWidth, 0), 1);
    wiper.style.left = `${view.wipe * 100}%`;
    screen.draw();
  });

  // `look` asks again what is where the pointer rests; `isOver` is whether somebody still wants to know.
  return { choose, look, isOver: () => spot !== null, chosen: (x, y) => clicked === `${x},${y}` && ((clicked = null), true) };
}

function marquee([x0, y0], [x1, y1]) {
  const box = $("marquee");
  box.hidden = false;
  const px = (n) => `${n}px`;
  Object.assign(box.style, {
    left: px(Math.min(x0, x1)), top: px(Math.min(y0, y1)), width: px(Math.abs(x1 - x0)), height: px(Math.abs(y1 - y0)),
  });
}
