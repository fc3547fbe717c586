// Keys, and the sheet that explains them.

const KEYS = (act) => [
  [" ", "Space", "stop or continue the render", act.run],
  ["n", "N", "begin the image anew", act.restart],
  ["[", "[", "darker by a quarter stop", () => act.exposure(-0.25)],
  ["]", "]", "brighter by a quarter stop", () => act.exposure(0.25)],
  ["0", "0", "exposure as at the beginning", () => act.exposure(0)],
  ["t", "T", "next tone map", act.curve],
  ["l", "L", "false colour: stops from middle grey", act.falseColor],
  ["v", "V", "next of what can be shown: the image, albedo, normals, depth …", act.layer],
  ["m", "M", "everything as if made of clay, or as it is", act.clay],
  ["f", "F", "fit the image", act.fit],
  ["1", "1", "a pixel for a pixel", act.actual],
  ["w", "W", "wipe between before and now", act.wipe],
  ["b", "B", "show the image of before", act.swap],
  ["d", "D", "difference, four times as strong", act.difference],
  ["c", "C", "move the camera with the pointer", () => act.tool("camera")],
  ["r", "R", "draw the region to render", () => act.tool("region")],
  ["a", "A", "render all of it again", act.whole],
  ["s", "S", "save what is shown as PNG", act.save],
  ["p", "P", "show or hide the panel", act.panel],
  ["?", "?", "this sheet", act.help],
];

export function addKeys(actions) {
  const keys = KEYS(actions);
  const sheet = document.getElementById("keys");
  for (const [, name, meaning] of keys) {
    sheet.append(
      Object.assign(document.createElement("dt"), { textContent: name }),
      Object.assign(document.createElement("dd"), { textContent: meaning }),
    );
  }
  document.addEventListener("keydown", (event) => {
    const isTyping = event.target.matches?.("input[type=number], textarea, select");
    if (isTyping && ["Enter", "Escape"].includes(event.key)) event.target.blur();
    const isPressing = event.key === " " && event.target.matches?.("button, summary, input[type=color]");
    // Some keyboards need AltGr, or Option, for brackets.
    const isBracket = event.altKey && ["[", "]"].includes(event.key);
    const isCommand = !isBracket && (event.ctrlKey || event.metaKey || event.altKey);
    if (isTyping || isPressing || isCommand || document.querySelector("dialog[open]")) return;
    const found = keys.find(([key]) => key === event.key.toLowerCase());
    if (!found) return;
    event.preventDefault();
    found[3]();
  });
  // What is used with the pointer gives the keys back; who goes about with keys stays where they are.
  let isPointed = false;
  document.addEventListener("pointerdown", () => (isPointed = true), true);
  document.addEventListener("keydown", () => (isPointed = false), true);
  document.addEventListener("click", ({ target }) => isPointed && target.closest("button")?.blur());
  document.addEventListener("change", ({ target }) => isPointed && target.matches("select") && target.blur());
}
