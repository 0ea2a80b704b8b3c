// A menu of files. Tables and the report come from the server in an answer; pictures are drawn here.

const FONT = "system-ui, sans-serif";
const EDGE = 14;

function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link); // Firefox follows only links of the page
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function* within(view) {
  if (view.model.type === "Figure") {
    if (view.model.visible && view.el.offsetParent !== null) yield view;
    return;
  }
  for (const child of view.child_views ?? []) yield* within(child);
}

function wrapped(context, text, width) {
  const lines = [];
  for (const paragraph of text.split("\n")) {
    let line = "";
    for (const word of paragraph.split(" ")) {
      const longer = line ? `${line} ${word}` : word;
      if (line && context.measureText(longer).width > width) { lines.push(line); line = word; }
      else line = longer;
    }
    lines.push(line);
  }
  return lines;
}

/** Where everything goes: heading, plots as they stand on the page, words below. */
function laidOut(plots, file) {
  const boxes = plots.map((plot) => plot.el.getBoundingClientRect());
  const left = Math.min(...boxes.map((b) => b.left));
  const top = Math.min(...boxes.map((b) => b.top));
  const width = Math.max(...boxes.map((b) => b.right)) - left + 2 * EDGE;
  const bottom = Math.max(...boxes.map((b) => b.bottom)) - top + 38;
  const context = document.createElement("canvas").getContext("2d");
  context.font = `12px ${FONT}`;
  const words = wrapped(context, file.text, width - 2 * EDGE)
    .map((text, i) => ({ text, x: EDGE, y: bottom + 18 + 16 * i, font: `12px ${FONT}` }));
  const heading = { text: file.title, x: EDGE, y: 24, font: `600 15px ${FONT}` };
  const [first] = plots;
  return {
    width: Math.ceil(width),
    height: Math.ceil(bottom + 16 * words.length + 18),
    places: boxes.map((b) => [b.left - left + EDGE, b.top - top + 38]),
    lines: [heading, ...words],
    paper: first.model.border_fill_color,
    ink: first.model.xaxis?.[0]?.axis_label_text_color ?? getComputedStyle(first.el).color,
  };
}

function png(plots, at) {
  const layers = plots.map((plot) => plot.export("png"));
  const ratio = layers[0].pixel_ratio;
  const canvas = document.createElement("canvas");
  canvas.width = ratio * at.width;
  canvas.height = ratio * at.height;
  const context = canvas.getContext("2d");
  context.fillStyle = at.paper;
  context.fillRect(0, 0, canvas.width, canvas.height);
  layers.forEach((layer, i) => context.drawImage(layer.canvas, ...at.places[i].map((v) => Math.round(ratio * v))));
  context.scale(ratio, ratio);
  context.fillStyle = at.ink;
  for (const { text, x, y, font } of at.lines) {
    context.font = font;
    context.fillText(text, x, y);
  }
  return new Promise((resolve) => { canvas.toBlob(resolve, "image/png"); });
}

function svg(plots, at) {
  const made = (tag, attributes, ...children) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    node.append(...children);
    return node;
  };
  const { width, height } = at;
  const drawn = plots.map((plot, i) => {
    const inner = plot.export("svg", false).ctx.get_serialized_svg(true);
    const parsed = new DOMParser().parseFromString(inner, "image/svg+xml").documentElement;
    const unique = (text) => text.replace(/(id="|url\(#|url\("#|href="#)/g, `$1p${i}-`);
    const own = new DOMParser().parseFromString(
      unique(new XMLSerializer().serializeToString(parsed)), "image/svg+xml").documentElement;
    const [x, y] = at.places[i];
    own.setAttribute("x", x);
    own.setAttribute("y", y);
    return own;
  });
  const root = made("svg", { width, height, viewBox: `0 0 ${width} ${height}` },
    made("rect", { width, height, fill: at.paper }), ...drawn,
    ...at.lines.map(({ text, x, y, font }) => made("text", { x, y, fill: at.ink, style: `font: ${font}` }, text)));
  return new Blob([new XMLSerializer().serializeToString(root)], { type: "image/svg+xml" });
}

const TYPES = { csv: "text/csv;charset=utf-8", report: "text/html;charset=utf-8" };

export function render({ model, view }) {
  const box = document.createElement("details");
  const opener = document.createElement("summary");
  opener.setAttribute("aria-label", `download ${model.subject}`);
  opener.title = "Download";
  opener.textContent = "⤓";
  const list = document.createElement("ul");
  for (const [kind, label] of model.kinds) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.dataset.kind = kind;
    button.addEventListener("click", () => {
      close();
      model.send_msg({ kind });
    });
    const item = document.createElement("li");
    item.append(button);
    list.append(item);
  }
  box.append(opener, list);

  function close() {
    if (box.open) opener.focus();
    box.open = false;
  }
  box.addEventListener("keydown", (event) => { if (event.key === "Escape") close(); });
  box.addEventListener("focusout", (event) => {
    if (event.relatedTarget && !box.contains(event.relatedTarget)) box.open = false;
  });
  const elsewhere = (event) => { if (!event.composedPath().includes(box)) box.open = false; };
  document.addEventListener("pointerdown", elsewhere);
  model.on("remove", () => document.removeEventListener("pointerdown", elsewhere));

  model.on("msg:custom", async (file) => {
    if (file.kind in TYPES) {
      save(file.name, new Blob([file.text], { type: TYPES[file.kind] }));
      return;
    }
    const plots = [...within(view.parent)];
    if (plots.length === 0) return;
    const draw = file.kind === "svg" ? svg : png;
    save(file.name, await draw(plots, laidOut(plots, file)));
  });
  return box;
}
