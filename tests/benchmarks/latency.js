// Watches when canvases are painted, and moves sliders. Added to every page before it loads.
window.painted = { last: 0, canvases: new Map() };
for (const name of ["stroke", "fill", "drawImage", "fillRect", "clearRect"]) {
  const original = CanvasRenderingContext2D.prototype[name];
  CanvasRenderingContext2D.prototype[name] = function (...args) {
    window.painted.last = performance.now();
    window.painted.canvases.set(this.canvas, window.painted.last);
    return original.apply(this, args);
  };
}

function* elements(root, selector) {
  for (const node of root.querySelectorAll("*")) {
    if (node.matches(selector)) yield node;
    if (node.shadowRoot) yield* elements(node.shadowRoot, selector);
  }
}

/** Find the sliders and listen for data; resolve with how many sliders and plots there are. */
window.prepare = (kind) => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const plots = models.filter((model) => model.type === "Figure" && model.visible).length;
  const arrive = (count) => { window.arrivals = count; window.arrived = performance.now(); };
  if (kind === "ours") {
    const sidebar = models.find((model) => model.class_name === "Sidebar");
    const inputs = [...elements(document, "input[type=range]")];
    window.arrivals = 0;
    window.move = (name, position) => {
      const input = inputs.find((node) => node.dataset.name === name);
      input.value = position;
      input.dispatchEvent(new Event("input"));
    };
    sidebar.data.properties.answered.change.connect(() => arrive(window.arrivals + 1));
    return { sliders: inputs.length, plots };
  }
  const sources = models.filter((model) => model.type === "ColumnDataSource");
  const sliders = models.filter((model) => model.type === "Slider");
  const counts = sources.map(() => 0);
  sources.forEach((source, i) => source.properties.data.change.connect(() => {
    counts[i] += 1;
    arrive(Math.min(...counts));
  }));
  window.arrivals = 0;
  window.move = (name, position) => { sliders[3].value = position / 100; };
  return { sliders: sliders.length, plots };
};

/**
 * Move a slider; resolve with the ms until the new answer is painted, and until the last canvas is.
 * What follows within `quiet` ms of a painting belongs to the same move. It begins at any moment of
 * a frame, as a hand does: the test's own steps come soon after a frame, and all times would be
 * whole frames.
 */
window.timedMove = async (...move) => {
  await new Promise((resolve) => { setTimeout(resolve, (Math.random() * 1000) / 60); });
  return movedAndTimed(...move);
};
const movedAndTimed = (name, position, quiet = 80, timeout = 10000) => new Promise((resolve, reject) => {
  const { painted } = window;
  const before = window.arrivals;
  const start = performance.now();
  let first = null;
  window.move(name, position);
  const look = () => {
    const now = performance.now();
    const isNew = window.arrivals > before && painted.last > window.arrived;
    if (isNew && first === null) first = painted.last - start;
    if (isNew && now - painted.last > quiet) resolve([first, painted.last - start]);
    else if (now - start > timeout) reject(new Error(`no new picture after ${timeout} ms`));
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
});

/** Drag for two seconds at 60 events a second; resolve with the ms from the last event to quiet. */
window.drag = (name, from, to, events = 120, gap = 1000 / 60, quiet = 250) => new Promise((resolve) => {
  const { painted } = window;
  const start = performance.now();
  let sent = 0;
  let last = 0;
  const send = () => {
    const due = Math.min(events, Math.floor((performance.now() - start) / gap));
    if (sent < due) {
      sent = due;
      window.move(name, from + ((to - from) * sent) / events);
      last = performance.now();
    }
    if (sent < events) { setTimeout(send, gap / 2); return; }
    const look = () => {
      const now = performance.now();
      if (now - Math.max(painted.last, last) > quiet) resolve(painted.last - last);
      else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  };
  send();
});

/** Wait for the next press of the pointer; resolve with the ms until its motion is painted. */
window.timedClick = () => new Promise((resolve) => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const motion = models.find((model) => model.name === "motion-motion");
  let start = null;
  let arrived = null;
  window.addEventListener("pointerdown", () => { start = performance.now(); }, { once: true });
  motion.properties.data.change.connect(() => {
    if (start !== null && motion.data.t.length) arrived = performance.now();
  });
  const look = () => {
    if (arrived !== null && painted.last > arrived) resolve(painted.last - start);
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
});
