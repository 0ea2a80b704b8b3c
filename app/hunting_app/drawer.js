// The designs that were kept. The server owns them; this browser remembers them.

const MEMORY = "hunting-designs";

/** Text with K_y and its like written as symbols. */
function symbols(text) {
  return text.split(/(\p{L}_[\p{L}\d]+)/u).map((part, k) => {
    if (k % 2 === 0) return part;
    const [letter, below] = part.split("_");
    return element("span", {}, element("i", {}, letter), element("sub", {}, below));
  });
}

export function render({ model }) {
  const box = element("div", { class: "designs" });
  const act = sender(model, box);
  const button = (label, title, onclick, attributes = {}) => element("button",
    { type: "button", title, "aria-label": title, onclick, ...attributes }, label);
  const toggle = element("button", {
    class: "opener", type: "button", "aria-expanded": "false", "aria-controls": "designs", title: "Named designs to compare and switch between",
    onclick: () => open(sheet.hidden),
  });
  const keep = element("button", {
    type: "button", class: "keep", title: "Keep what is on the sliders now as a named design",
    onclick: () => act({ keep: true }),
  }, "Keep this design");
  const exports = ["csv", "json"].map((kind) => element("button", {
    type: "button", title: `Save all designs as a ${kind.toUpperCase()} file`, onclick: () => act({ export: kind }),
  }, kind.toUpperCase()));
  const close = button("✕", "close the designs", () => open(false), { class: "close" });
  const body = element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "kept designs" });
  const sheet = element("section", {
    id: "designs", class: "sheet", hidden: true, "aria-label": "designs",
    onkeydown: (event) => { if (event.key === "Escape" && !isTyping(event)) open(false); },
  }, element("div", { class: "head" }, element("h2", {}, "Designs"), keep, ...exports, close), body);

  function open(wanted) {
    sheet.hidden = !wanted;
    toggle.setAttribute("aria-expanded", String(wanted));
    act({ open: wanted });
    (wanted ? keep : toggle).focus();
  }

  function head() {
    const speeds = model.columns.map(([subscript, vehicle]) => element("th", { scope: "col", class: "number" },
      element("i", {}, "V"), element("sub", {}, subscript), ` ${vehicle} [km/h]`));
    const cells = ["Name", ...speeds, "Changed parameters", "Use", "Order"];
    return element("tr", {}, ...cells.map((c) => c instanceof Element ? c : element("th", { scope: "col" }, c)));
  }
  function line(row, at) {
    const { name } = row;
    const ask = (key, label, title, change, off = false) => button(label, title,
      () => act({ design: name, ...change }), { "data-key": `${at} ${key}`, disabled: off });
    const box_ = element("input", {
      type: "text", value: name, "aria-label": `name of ${name}`, "data-key": `${at} name`,
      onchange: ({ target }) => {
        const asked = target.value;
        target.value = name; // until the server agrees
        act({ design: name, rename: asked });
      },
      onkeydown: (event) => { if (event.key === "Escape") { event.target.value = name; event.stopPropagation(); } },
    });
    return element("tr", { class: row.shown ? "shown" : "", "data-design": name },
      element("td", {}, box_),
      ...row.speeds.map((text) => element("td", { class: "number" }, text)),
      element("td", { class: "changed" }, ...symbols(row.changed)),
      element("td", { class: "acts" },
        ask("show", row.shown ? "Shown" : "Show", `show ${name}: put its values on the sliders`, { show: true }, row.shown),
        ask("pin", row.pinned ? "Baseline" : "Pin", `pin ${name} as baseline`, { pin: true }, row.pinned)),
      element("td", { class: "acts" },
        ask("up", "↑", `move ${name} up`, { move: -1 }, at === 0),
        ask("down", "↓", `move ${name} down`, { move: 1 }, at === model.rows.length - 1),
        ask("delete", "✕", `delete ${name}`, { delete: true })));
  }
  /** Draw the table anew; the focus stays on the same button of the design that was acted on. */
  let focused = null;
  function show() {
    toggle.textContent = model.count ? `Designs (${model.count})` : "Designs";
    for (const one of exports) one.disabled = model.rows.length === 0;
    exports[0].disabled ||= model.rows.some((row) => row.speeds.includes("…"));
    if (sheet.hidden) return;
    const active = box.getRootNode().activeElement;
    const [was, key] = active?.dataset?.key ? [active.closest("tr").dataset.design, active.dataset.key] : [];
    body.replaceChildren(model.rows.length
      ? element("table", {}, element("thead", {}, head()), element("tbody", {}, ...model.rows.map(line)))
      : element("p", {}, "No design is kept yet. Keep what is on the sliders now, change something, keep "
        + "that too, and compare. They stay in this browser; links do not hold them, but files do."));
    if (key) refocus(was, key, active.value);
  }
  /** Back to the button or box that had the focus: of this design, or of what is in its place. */
  function refocus(name, key, typed) {
    const [at, kind] = key.split(" ");
    const lines = [...body.querySelectorAll("tr[data-design]")];
    const place = lines.find((one) => one.dataset.design === name) ?? lines[at] ?? lines.at(-1);
    const same = place?.querySelector(`[data-key$=" ${kind}"]:enabled`);
    (same ?? place?.querySelector("button:enabled") ?? keep).focus();
    if (kind === "name" && same && typed !== name) same.value = typed; // not finished yet
  }

  let planned = false;
  const plan = () => {
    if (planned) return;
    planned = true;
    queueMicrotask(() => { planned = false; show(); });
  };
  for (const name of ["rows", "columns", "count"]) model.on(name, plan);
  model.on("msg:custom", download);

  function remember() {
    try { window.localStorage.setItem(MEMORY, model.stored); } catch { /* full or forbidden: kept in the session alone */ }
  }
  function recall(text) { if (text && text !== model.stored) act({ stored: text }); }
  const fromOtherTab = (event) => { if (event.key === MEMORY) recall(event.newValue); };
  if (model.served) {
    model.on("stored", remember);
    try { recall(window.localStorage.getItem(MEMORY)); } catch { /* forbidden */ }
    window.addEventListener("storage", fromOtherTab);
    model.on("remove", () => window.removeEventListener("storage", fromOtherTab));
  }
  box.append(toggle, sheet);
  show();
  return box;
}
