// Which variants of the imports are shown.

const $ = (id) => document.getElementById(id);

// Adds a menu for each set of variants; `send` gets what is chosen.
export function showVariants(imports, send) {
  $("variants-section").hidden = imports.length === 0;
  const known = JSON.stringify(imports);
  if ($("variants").dataset.known === known) return;
  $("variants").dataset.known = known;
  $("variants").replaceChildren(...imports.flatMap(({ name, variants }) => {
    // A program is told all that is chosen of an import, not only what changes.
    const menus = variants.map((set) => menu(set));
    const choose = () => send({ do: "variants", import: name, variants: menus.map((it) => it.value).filter(Boolean) });
    return menus.map((select, i) => {
      const label = Object.assign(document.createElement("label"), { textContent: titleOf(name, variants[i].name) });
      label.append(select);
      select.onchange = choose;
      return label;
    });
  }));
}

function titleOf(asset, set) {
  return set ? `${asset}, ${set.replace(/^.*\//, "").replace(":", " ")}` : asset;
}

function menu({ name, choices, chosen }) {
  const select = document.createElement("select");
  const short = (choice) => (name && choice.startsWith(`${name}=`) ? choice.slice(name.length + 1) : choice);
  const asItIs = new Option("as the file shows", "");
  // Where the file itself says which one, that one is not "none".
  select.append(...(name && chosen ? [] : [asItIs]), ...choices.map((choice) => new Option(short(choice), choice)));
  select.value = chosen ?? "";
  return select;
}
