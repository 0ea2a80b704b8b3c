// The sidebar. The server owns the values; this file shows them and sends what the hand does.

const FINE = 400; // positions of a slider
const REST = 400; // ms without a move after which the hand is said to rest

/** A channel with at most one message in flight; what waits is merged by key. */
class Channel {
  constructor(model, box) {
    this.model = model;
    this.box = box; // its data-busy says whether anything is still to come
    this.number = model.answered;
    this.waiting = new Map();
    this.inFlight = false;
    model.on("answered", () => { this.inFlight = false; this.flush(); this.tell(); });
  }
  send(key, act) {
    this.waiting.delete(key); // so that it comes after what was done since
    this.waiting.set(key, act);
    if (!this.inFlight) this.flush();
    clearTimeout(this.resting);
    this.resting = key === "rest" ? null : setTimeout(() => this.send("rest", { rest: true }), REST);
    this.tell();
  }
  tell() { this.box.dataset.busy = this.inFlight || this.resting ? "yes" : "no"; }
  flush() {
    if (this.waiting.size === 0) return;
    const acts = [...this.waiting.values()];
    this.waiting.clear();
    this.inFlight = true;
    this.number += 1;
    this.model.send_msg({ acts, number: this.number });
  }
  isPending(key) { return this.waiting.has(key); }
}

/** Usual notation, to seven digits: 86,700 and 1.5913e7. */
export function written(value) {
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-4 || size >= 1e6)
    ? value.toExponential(6).replace(/\.?0+e/, "e").replace("e+", "e")
    : value.toLocaleString("en-US", { maximumSignificantDigits: 7 });
  return text.replaceAll("-", "−");
}

/** 1, 2 or 5 times a power of ten, at most `size`. */
function niceBelow(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return [5, 2, 1].find((s) => s * power <= size) * power;
}

/** Where a value sits on a slider and back; logarithmic or linear. */
class Scale {
  constructor(row) {
    this.log = row.log;
    [this.low, this.high] = row.span;
  }
  /** Make room for a value beyond the usual range. */
  widen(value) {
    if (this.log) {
      if (value > this.high) this.high = value;
      if (value > 0 && value < this.low) this.low = value;
    } else {
      this.high = Math.max(this.high, value);
      this.low = Math.min(this.low, value);
    }
  }
  position(value) {
    const t = this.log
      ? Math.log(Math.max(value, this.low) / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return FINE * t;
  }
  value(position) {
    const t = position / FINE;
    if (t >= 1) return this.high;
    if (t <= 0) return this.low;
    if (this.log) return Number((this.low * (this.high / this.low) ** t).toPrecision(3));
    const step = niceBelow((this.high - this.low) / FINE);
    const value = Math.round((this.low + (this.high - this.low) * t) / step) * step;
    return Number(value.toPrecision(12));
  }
}

function symbol(row) {
  return element("span", { class: "symbol" }, element("i", {}, row.symbol),
    row.subscript ? element("sub", {}, row.subscript) : null);
}

/** One parameter: symbol, slider, box, unit, reset. */
class Row {
  constructor(row, channel, tip) {
    this.channel = channel;
    this.tip = tip;
    const id = `row-${row.name}`;
    this.slider = element("input", {
      type: "range", id, min: 0, max: FINE, step: 1,
      "aria-describedby": `${id}-meaning`, "data-name": row.name,
      oninput: () => this.slide(), onpointerdown: () => { this.held = true; },
      onpointerup: () => { this.held = false; }, onblur: () => { this.held = false; },
    });
    this.box = element("input", {
      type: "text", inputmode: "decimal",
      "aria-describedby": `${id}-meaning ${id}-refusal`, autocomplete: "off", spellcheck: "false",
      "data-name": row.name,
      onchange: () => this.type(), onfocus: () => this.box.select(),
      onkeydown: (event) => this.press(event),
    });
    this.back = element("button", {
      type: "button", class: "back", title: "put back to the preset's value",
      "aria-label": `put ${row.label} back to the preset's value`,
      onclick: () => channel.send(`set ${row.name}`, { reset: [row.name] }),
    }, "↺");
    this.unit = element("span", { class: "unit" });
    this.refusal = element("p", { class: "refusal", id: `${id}-refusal`, role: "alert" });
    this.node = element("div", {
      class: "row", "data-row": row.name,
      onpointerenter: () => tip.show(this.node, this.row, this.meaning), onpointerleave: () => tip.hide(),
      onfocusin: (event) => { if (event.target.matches(":focus-visible")) tip.show(this.node, this.row, this.meaning); },
      onfocusout: () => tip.hide(),
    }, element("label", { for: id }, symbol(row)), this.slider, this.box,
      this.unit, this.back, this.refusal,
      this.meaning = element("span", { class: "hidden", id: `${id}-meaning` }, row.meaning));
    this.measureIn(row);
  }
  /** Take the unit, the range and with them the meaning of a value from `row`. */
  measureIn(row) {
    this.row = row;
    this.scale = new Scale(row);
    this.value = undefined; // to be shown anew
    this.unit.textContent = row.unit;
    this.slider.setAttribute("aria-label", `${row.label} [${row.unit}]`);
    this.box.setAttribute("aria-label", `${row.label}, value [${row.unit}]`);
  }
  get key() { return `set ${this.row.name}`; }
  slide() {
    const value = this.scale.value(this.slider.valueAsNumber);
    this.box.value = written(value);
    this.describe(value);
    this.send(value);
  }
  press(event) {
    if (event.key === "Enter") event.stopPropagation(); // a notebook would take it, and the box keep still
    if (event.key === "Escape") this.show(this.value, this.base, null, this.idle);
  }
  type() { this.send(this.box.value); }
  send(value) {
    this.isAhead = true;
    this.channel.send(this.key, { set: this.row.name, to: value, units: this.channel.model.units });
  }
  /** Show the server's value, unless the hand is already further. */
  show(value, base, refused, idle) {
    this.idle = idle;
    this.node.classList.toggle("idle", Boolean(idle));
    const meaning = idle ? `${this.row.meaning} ${idle}` : this.row.meaning;
    if (this.meaning.textContent !== meaning) this.meaning.textContent = meaning;
    if (this.channel.isPending(this.key)) return;
    const typed = refused && this.box.value;
    const answered = this.isAhead && !this.channel.inFlight; // if only by something done since
    if (answered) this.isAhead = false;
    if (value !== this.value || refused || this.refusal.textContent || answered) {
      this.scale.widen(value);
      if (!this.held) this.slider.value = this.scale.position(value);
      this.box.value = typed || written(value);
      this.describe(value);
    }
    this.value = value;
    this.base = base;
    this.node.classList.toggle("changed", value !== base);
    this.node.classList.toggle("refused", Boolean(refused));
    this.back.disabled = value === base;
    this.box.setAttribute("aria-invalid", refused ? "true" : "false");
    const words = refused ? `${refused}. Still ${written(value)} ${this.row.unit}.` : "";
    if (this.refusal.textContent !== words) {
      this.refusal.textContent = words;
      if (words) this.tip.hide(); // it would cover them
    }
  }
  describe(value) {
    this.slider.style.setProperty("--at", `${100 * this.scale.position(value) / FINE}%`);
    this.slider.setAttribute("aria-valuetext", `${written(value)} ${this.row.unit}`);
  }
}

/** One bubble for the meaning of whichever row is pointed at. */
class Tip {
  constructor(box) {
    this.box = box;
    this.node = element("div", { class: "tip", "aria-hidden": "true" });
  }
  show(at, row, meaning) {
    this.node.replaceChildren(element("b", {}, symbol(row), ` ${row.label}`), ` ${meaning.textContent}`);
    this.node.classList.add("shown");
    const top = at.getBoundingClientRect().bottom - this.box.getBoundingClientRect().top;
    this.node.style.top = `${top + 2}px`;
  }
  hide() { this.node.classList.remove("shown"); }
}

/** Keys typed here are ours: a notebook would take them for its shortcuts. */
function keepKeys(node) {
  let host = node;
  while (host.getRootNode() instanceof ShadowRoot) host = host.getRootNode().host;
  host.dataset.lmSuppressShortcuts = "true";
}

function choice(name, legend, options, send) {
  const inputs = new Map();
  const node = element("fieldset", { class: "choice" }, element("legend", {}, legend));
  for (const [key, label, note] of options) {
    const input = element("input", { type: "radio", name, value: key, onchange: () => send(key) });
    inputs.set(key, input);
    node.append(element("label", { title: note }, input, element("span", {}, label)));
  }
  return { node, show: (key) => { inputs.get(key).checked = true; } };
}

export function render({ model }) {
  const box = element("div", { class: "panel", "data-busy": "no" });
  const channel = new Channel(model, box);
  const tip = new Tip(box);
  const presets = choice("preset", "Preset", model.presets,
    (key) => channel.send("preset", { preset: key }));
  const vehicles = choice("vehicle", "Vehicle", model.vehicles.map((v) => [v, v]),
    (key) => channel.send("vehicle", { vehicle: key }));
  const units = choice("units", "Units", model.unit_systems,
    (key) => channel.send("units", { units: key }));
  const provenance = element("p", { class: "provenance" });
  const note = element("p", { class: "provenance" }, "Grey: hardly moves V", element("sub", {}, "nl"),
    " or V", element("sub", {}, "lin"), " here.");
  const resetAll = element("button", {
    type: "button", class: "reset-all",
    onclick: () => channel.send("reset", { reset: rows.map((r) => r.row.name).filter((n) => n !== "V") }),
  }, "Put all back");

  const rows = model.rows.map((row) => new Row(row, channel, tip));
  const groups = new Map();
  for (const row of rows) {
    if (!groups.has(row.row.group)) groups.set(row.row.group, []);
    groups.get(row.row.group).push(row);
  }
  const backs = [];
  /** The rows of a group, folded by its name, and what puts them all back. */
  function folded(name, members) {
    const back = element("button", {
      type: "button", class: "back", title: `put ${name} back to the preset's values`,
      "aria-label": `put all of ${name} back to the preset's values`,
      onclick: () => channel.send(`reset ${name}`, { reset: members.map((r) => r.row.name) }),
    }, "↺");
    backs.push(() => { back.disabled = members.every((r) => r.value === r.base); });
    return element("div", { class: "group", "data-group": name },
      element("details", { open: true }, element("summary", {}, name), ...members.map((r) => r.node)),
      back);
  }
  const [speed, ...others] = [...groups].map(([name, members]) => name === "speed"
    ? element("div", { class: "speed" }, ...members.map((r) => r.node))
    : folded(name, members));
  const wide = window.matchMedia("(min-width: 801px)");
  const fold = element("details", { class: "fold", open: wide.matches },
    element("summary", {}, "Parameters"), provenance, ...others,
    element("div", { class: "foot" }, resetAll, units.node), note);
  const refold = () => { fold.open = wide.matches; };
  wide.addEventListener("change", refold);
  model.on("remove", () => wide.removeEventListener("change", refold));
  box.append(presets.node, vehicles.node, speed, fold, tip.node);

  function show() {
    for (const row of rows) {
      const name = row.row.name;
      row.show(model.values[name], model.base[name], model.refused[name], model.idle[name]);
    }
    if (!channel.isPending("preset")) presets.show(model.preset);
    if (!channel.isPending("vehicle")) vehicles.show(model.vehicle);
    if (!channel.isPending("units")) units.show(model.units);
    provenance.textContent = model.provenance;
    note.hidden = Object.keys(model.idle).length === 0;
    for (const showBack of backs) showBack();
    resetAll.disabled = others.length && !rows.some((r) => r.row.name !== "V" && r.value !== r.base);
  }
  let planned = false; // several values arrive in one update: show them once
  const plan = () => {
    if (planned) return;
    planned = true;
    queueMicrotask(() => { planned = false; show(); });
  };
  for (const name of ["values", "base", "preset", "vehicle", "refused", "idle", "provenance", "answered"]) {
    model.on(name, plan);
  }
  model.on("rows", () => {
    rows.forEach((row, i) => row.measureIn(model.rows[i]));
    plan();
  });
  model.on("after_render", () => keepKeys(box));
  show();
  return box;
}
