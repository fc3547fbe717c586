// What is going on, in words.

const $ = (id) => document.getElementById(id);

export function duration(seconds) {
  const s = Math.round(seconds);
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (s < 120) return `${s} s`;
  return s < 7200 ? `${Math.floor(s / 60)} min` : `${Math.floor(s / 3600)} h ${Math.floor((s / 60) % 60)} min`;
}

export function samples(count) {
  return `${count} ${count === 1 ? "sample" : "samples"} a pixel`;
}

let silence = null;

// Says something for a moment.
export function say(text) {
  $("said").textContent = text;
  $("said").hidden = false;
  clearTimeout(silence);
  silence = setTimeout(() => ($("said").hidden = true), 4000);
}

export function showState(state) {
  const name = state.scene.split(/[\\/]/).pop();
  $("name").textContent = name;
  $("name").title = state.scene;
  document.title = `${name} – Ajar`;
  $("phase").textContent = state.phase;
  $("phase").dataset.phase = state.phase;
  const percent = (share) => `${(share * 100).toFixed(share < 0.1 ? 1 : 0)} %`;
  const noise = state.noise === null ? "noise not yet known" : `noise ${percent(state.noise)} (worst ${percent(state.worst_tile)})`;
  const left = state.seconds_left === null || state.phase !== "rendering" ? "" : `, about ${duration(state.seconds_left)} left`;
  const [width, height] = state.size;
  const rounds = state.rounds ? `${samples(state.samples)}, ${noise}, ${duration(state.seconds)}${left}`
    : `no round finished yet${state.samples ? `, eye paths of ${samples(state.samples)} meanwhile` : ""}`;
  $("numbers").textContent = state.image === 0 ? "" : `${width}×${height}, ${rounds}`;
  $("changed").textContent = state.shown_for.length ? `changed: ${state.shown_for.join(", ")}` : "";
  $("rejected").textContent = state.rejected > 0 ? `${state.rejected} contributions were negative or not finite and are left out` : "";
  $("progress").value = state.phase === "done" ? 1 : state.done;
  const isRunning = state.phase === "rendering";
  $("run").textContent = isRunning ? "Stop" : "Continue";
  $("clay").classList.toggle("on", state.is_clay);
  $("restart").disabled = false;
  $("run").disabled = !["rendering", "stopped", "done"].includes(state.phase);
  showErrors(state.errors);
  showEdits(state);
}

function showErrors(errors) {
  $("banner").hidden = errors.length === 0;
  $("banner").replaceChildren(...errors.slice(0, 8).map(lineOf));
}

// Nothing can be shown at all.
export function cannot(message) {
  showErrors([{ severity: "error", message }]);
  $("phase").textContent = "not shown";
  $("phase").dataset.phase = "waiting";
}

const MISSING = {
  closed: "The program is not there. This page goes on when it is back.",
  full: "Too many pages show this program. This one goes on when another is closed.",
};

// How the connection stands.
export function showLink(is) {
  document.body.dataset.link = is;
  $("offline").hidden = is === "open";
  if (is === "open") return;
  $("offline").textContent = MISSING[is];
  $("phase").textContent = $("phase").dataset.phase = "offline";
  $("run").disabled = $("restart").disabled = true;
}

// What was said of the scene that is shown, and is no reason not to show it.
export function showNotes(notes) {
  $("notes-section").hidden = notes.length === 0;
  const warnings = notes.filter(({ severity }) => severity === "warning").length;
  $("notes-title").textContent = warnings ? `Notes (${notes.length}, ${warnings} of them warnings)` : `Notes (${notes.length})`;
  $("notes").replaceChildren(...notes.map(lineOf));
}

function lineOf({ severity, file, place, element, message, hint }) {
  const line = Object.assign(document.createElement("p"), { className: severity });
  const name = file?.split(/[\\/]/).pop();
  const where = document.createElement("code");
  where.textContent = [name, ...(place ?? [])].filter(Boolean).map((part) => `${part}:`).join("") + " ";
  where.title = file ?? "";
  line.append(where, [element, message].filter(Boolean).join(": "));
  if (hint) line.append(Object.assign(document.createElement("span"), { className: "hint", textContent: ` – ${hint}` }));
  return line;
}

function showEdits({ edits, saved, saved_without }) {
  $("edits").textContent = edits || "None.";
  for (const id of ["copy", "save", "revert"]) $(id).disabled = !edits;
  const without = saved_without?.length ? `, without ${saved_without.join(", ")}` : "";
  $("saved").textContent = saved ? `Saved as ${saved}${without}` : "";
}

// What is at a pixel; JSON says null for what is not finite.
export function showProbe({ x, y, value, error, hit }) {
  const number = (v) => (v === null ? "not finite" : v.toPrecision(4)).padStart(10);
  const rows = ["R", "G", "B"].map((name, i) => `${name} ${number(value[i])}` + (error ? ` ± ${error[i].toPrecision(2)}` : ""));
  $("probe").textContent = [`(${x}, ${y})`, ...rows, ...(hit ? wordsOf(hit) : [])].join("\n");
  $("probe").hidden = false;
}

function wordsOf({ object, material, depth, normal }) {
  const place = `${depth.toPrecision(4)} m away, normal ${normal.map((n) => n.toFixed(2)).join(" ")}`;
  return [object && `object ${object}`, material && `material ${material}`, place].filter(Boolean);
}
