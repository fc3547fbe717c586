// What the pointer does over the image.

const $ = (id) => document.getElementById(id);

// A click moves less than this many pixels.
const CLICK = 4;
// Milliseconds between two looks at a pixel.
const PAUSE = 80;

export function addPointer({ screen, camera, send }) {
  const canvas = $("canvas"), view = screen.view;
  let tool = "look", drag = null, clicked = null, asked = 0;
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
  const probe = ([x, y], isChosen) => {
    const [px, py] = screen.pixelAt(x, y).map(Math.floor);
    const isInside = px >= 0 && py >= 0 && px < view.size[0] && py < view.size[1];
    $("probe").hidden = !isInside;
    if (!isInside) return;
    if (isChosen) clicked = `${px},${py}`;
    send({ do: "probe", x: px, y: py });
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
      camera.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      camera.dolly(before.apart / apart);
      return;
    }
    view.center = [view.center[0] - dx / view.zoom, view.center[1] - dy / view.zoom];
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
    const [x, y] = at(event);
    if (!drag) {
      if (performance.now() - asked > PAUSE) {
        asked = performance.now();
        probe([x, y], false);
      }
      return;
    }
    const [dx, dy] = [x - drag.last[0], y - drag.last[1]];
    drag.moved ||= Math.hypot(x - drag.start[0], y - drag.start[1]) >= CLICK;
    if (!drag.moved) return;
    drag.last = [x, y];
    const height = canvas.clientHeight;
    if (drag.kind === "move") {
      view.center = [view.center[0] - dx / view.zoom, view.center[1] - dy / view.zoom];
      screen.draw();
    } else if (drag.kind === "orbit") camera.orbit(dx / height, dy / height);
    else if (drag.kind === "pan") camera.pan(dx / height, dy / height);
    else if (drag.kind === "dolly") camera.dolly(Math.exp((dy * 2) / height));
    else marquee(drag.start, [x, y]);
  };
  const end = (event) => {
    fingers.delete(event.pointerId);
    if (!drag) return;
    const { kind, start, moved } = drag;
    drag = null;
    $("marquee").hidden = true;
    if (!moved && kind !== "region") probe(at(event), true);
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
  });
  canvas.addEventListener("pointerleave", () => ($("probe").hidden = true));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY / (event.deltaMode ? 8 : 400));
    if (tool === "camera" || event.altKey) camera.dolly(1 / factor);
    else screen.zoomAt(...at(event), factor);
  }, { passive: false });

  const wiper = $("wiper");
  wiper.addEventListener("pointerdown", (event) => wiper.setPointerCapture(event.pointerId));
  wiper.addEventListener("pointermove", (event) => {
    if (!wiper.hasPointerCapture(event.pointerId)) return;
    view.wipe = Math.min(Math.max(at(event)[0] / canvas.clientWidth, 0), 1);
    wiper.style.left = `${view.wipe * 100}%`;
    screen.draw();
  });

  return { choose, chosen: (x, y) => clicked === `${x},${y}` && ((clicked = null), true) };
}

function marquee([x0, y0], [x1, y1]) {
  const box = $("marquee");
  box.hidden = false;
  const px = (n) => `${n}px`;
  Object.assign(box.style, {
    left: px(Math.min(x0, x1)), top: px(Math.min(y0, y1)), width: px(Math.abs(x1 - x0)), height: px(Math.abs(y1 - y0)),
  });
}
