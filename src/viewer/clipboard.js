// Text for other programs.

import { say } from "./status.js";

export async function copy(text) {
  say((await isWritten(text)) ? "Copied." : "The browser does not let this page copy.");
}

async function isWritten(text) {
  // Browsers offer it to pages from this machine, not to those that come over plain HTTP from another one.
  if (navigator.clipboard) return navigator.clipboard.writeText(text).then(() => true, () => isSelected(text));
  return isSelected(text);
}

function isSelected(text) {
  const area = Object.assign(document.createElement("textarea"), { value: text });
  document.body.append(area);
  area.select();
  const isDone = document.execCommand("copy");
  area.remove();
  return isDone;
}
