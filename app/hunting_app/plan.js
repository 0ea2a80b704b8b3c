// The wheelset between the rails from above, over the motion that the time history shows.
const ENLARGED = 20;
const HALF_GAUGE = 750; // mm, drawn true to scale; displacements and clearance are enlarged
const RAIL = 90; // width of the drawn rail
const ROLES = ["motion", "hunting"];
const SVG = "http://www.w3.org/2000/svg";

function shape(tag, attributes, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

function wheelset(role) {
  return shape("g", { class: `wheelset ${role}` },
    shape("line", { x1: -HALF_GAUGE, x2: HALF_GAUGE, y1: 0, y2: 0 }),
    ...[-1, 1].flatMap(() => [
      shape("rect", { class: "tread", y: -330, height: 660 }),
      shape("line", { class: "flange", y1: -400, y2: 400 })]));
}

/** The columns of the motions, which Bokeh holds for the other plots. */
function motions(document) {
  return ROLES.map((role) => document?.get_model_by_name(`motion-${role}`));
}

export function render({ model, view }) {
  const rails = [-1, 1].map(() => shape("rect", { class: "rail", y: -900, height: 1800, width: RAIL }));
  const frame = shape("rect", {
    class: "frame", x: -520, y: -620, width: 1040, height: 1240,
  });
  const sets = ROLES.map(wheelset);
  const picture = shape("svg", {
    viewBox: "-1150 -720 2300 1440", role: "img",
    "aria-label": "plan view of the wheelset between the rails",
  }, ...rails, frame, ...sets);
  const play = document.createElement("button");
  play.type = "button";
  const clock = document.createElement("output");
  const note = document.createElement("p");
  const controls = document.createElement("div");
  controls.className = "controls";
  controls.append(play, clock);
  const box = document.createElement("div");
  box.className = "plan";
  box.append(controls, picture, note);

  const still = window.matchMedia("(prefers-reduced-motion: reduce)");
  const sources = motions(view?.model?.document ?? window.Bokeh?.documents?.[0]);
  let time = 0;
  let last = null; // of the animation's clock; null while it pauses
  let asked = 0;
  let length = 0; // s of the longer motion; one that leaves the model's range ends there

  /** A flange touches its rail where the enlarged displacement is the enlarged clearance. */
  function fit() {
    const gap = ENLARGED * model.clearance;
    rails.forEach((rail, i) => rail.setAttribute("x", i ? HALF_GAUGE : -HALF_GAUGE - RAIL));
    for (const set of sets) {
      const flanges = [...set.querySelectorAll(".flange")];
      [...set.querySelectorAll(".tread")].forEach((tread, i) => {
        const inner = HALF_GAUGE - gap;
        tread.setAttribute("width", gap + RAIL + 60);
        tread.setAttribute("x", i ? inner : -inner - gap - RAIL - 60);
        for (const end of ["x1", "x2"]) flanges[i].setAttribute(end, i ? inner : -inner);
      });
    }
  }
  function frames() {
    frame.style.display = model.frame ? "" : "none";
    const dashed = model.frame ? "; dashed: frame" : "";
    note.textContent = `From above, in real time. Movements ${ENLARGED} times enlarged${dashed}.`;
  }
  function measure() {
    length = Math.max(0, ...sources.map((source) => {
      const { t, y } = source?.data ?? {};
      let last = (t?.length ?? 0) - 1;
      while (last >= 0 && !Number.isFinite(y[last])) last -= 1;
      return last < 0 ? 0 : t[last];
    }));
  }
  function draw() {
    let shown = 0;
    sources.forEach((source, i) => {
      const { t, y, "ψ": psi, z } = source?.data ?? {};
      const rows = t?.length ?? 0;
      sets[i].style.display = rows || i === 0 ? "" : "none";
      const at = rows ? Math.min(rows - 1, Math.round((time / t[rows - 1]) * (rows - 1))) : 0;
      const [side, turn, below] = (rows ? [y[at], psi[at], z[at]] : [0, 0, 0])
        .map((value) => (Number.isFinite(value) ? value : 0));
      sets[i].setAttribute("transform",
        `translate(${ENLARGED * side} 0) rotate(${(ENLARGED * turn * 180) / 1000 / Math.PI})`);
      if (i === 0) frame.setAttribute("transform", `translate(${ENLARGED * below} 0)`);
      shown += rows;
    });
    clock.textContent = shown ? `t = ${time.toFixed(1)} s` : "no motion yet";
    play.disabled = !length;
    play.textContent = last === null ? "▶ Play" : "❚❚ Pause";
    play.setAttribute("aria-label", last === null ? "play the motion" : "pause the motion");
  }
  function step(now) {
    if (last === null) return;
    if (!box.isConnected || document.hidden || box.offsetParent === null) { pause(); return; }
    time = Math.max(0, time + (now - last) / 1000);
    if (time >= length) time = 0;
    last = now;
    draw();
    asked = requestAnimationFrame(step);
  }
  function start() {
    if (!length) return;
    last = performance.now();
    cancelAnimationFrame(asked);
    asked = requestAnimationFrame(step);
    draw();
  }
  function pause() {
    last = null;
    cancelAnimationFrame(asked);
    draw();
  }
  play.addEventListener("click", () => (last === null ? start() : pause()));
  function arrived() {
    time = 0;
    measure();
    if (length && !still.matches) start(); else pause();
  }
  let planned = false;
  const plan = () => {
    if (planned) return;
    planned = true;
    queueMicrotask(() => { planned = false; arrived(); });
  };
  for (const source of sources) source?.properties.data.change.connect(plan);
  model.on("clearance", fit);
  model.on("frame", frames);
  model.on("remove", pause);
  fit();
  frames();
  measure();
  draw();
  return box;
}
