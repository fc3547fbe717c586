// What is going on, in words.

const $ = (id) => document.getElementById(id);

export function duration(seconds) {
  const s = Math.round(seconds);
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (s < 120) return `${s} s`;
  return s < 7200 ? `${Math.floor(s / 60)} min` : `${Math.floor(s / 3600)} h ${Math.floor((s / 60) % 60)} min`;
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
  const left = state.seconds_left === null ? "" : `, about ${duration(state.seconds_left)} left`;
  const [width, height] = state.size;
  const rounds = state.rounds ? `${state.samples} samples a pixel, ${noise}, ${duration(state.seconds)}${left}` : "no round finished yet";
  $("numbers").textContent = state.image === 0 ? "" : `${width}×${height}, ${rounds}`;
  $("changed").textContent = state.shown_for.length ? `changed: ${state.shown_for.join(", ")}` : "";
  $("progress").value = state.phase === "done" ? 1 : state.done;
  const isRunning = state.phase === "rendering";
  $("run").textContent = isRunning ? "Stop" : "Continue";
  $("clay").classList.toggle("on", state.is_clay);
  $("run").disabled = !["rendering", "stopped", "done"].includes(state.phase);
  showErrors(state.errors);
  showEdits(state);
}

function showErrors(errors) {
  $("banner").hidden = errors.length === 0;
  $("banner").replaceChildren(...errors.slice(0, 8).map(lineOf));
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
  where.textContent = [name, ...(place ?? [])].filter(Boolean).join(":") + ": ";
  where.title = file ?? "";
  line.append(where, [element, message].filter(Boolean).join(": "));
  if (hint) line.append(Object.assign(document.createElement("span"), { className: "hint", textContent: ` – ${hint}` }));
  return line;
}

function showEdits({ edits, saved }) {
  $("edits").textContent = edits || "None.";
  for (const id of ["copy", "save", "revert"]) $(id).disabled = !edits;
  $("saved").textContent = saved ? `Saved as ${saved}` : "";
}

export function showProbe({ x, y, value, error, hit }) {
  const number = (v) => (v === null ? "NaN" : Number(v).toPrecision(4)).padStart(10);
  const rows = ["R", "G", "B"].map((name, i) => `${name} ${number(value[i])}` + (error ? ` ± ${Number(error[i]).toPrecision(2)}` : ""));
  const found = hit ? [hit.object, hit.material, `${Number(hit.depth).toPrecision(4)} m away, normal ${hit.normal.map((n) => n.toFixed(2)).join(" ")}`] : [];
  $("probe").textContent = [`(${x}, ${y})`, ...rows, ...found.filter(Boolean)].join("\n");
  $("probe").hidden = false;
}
