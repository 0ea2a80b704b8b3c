// Three hints, one after the other, on a first visit only.
const KEY = "hunting-hints";

function remembered() {
  try { return localStorage.getItem(KEY) !== null; } catch { return true; } // no storage: no hints
}

export function render({ model }) {
  const box = document.createElement("aside");
  if (remembered()) return box;
  box.className = "box";
  box.setAttribute("aria-label", "hints");
  const text = document.createElement("p");
  text.setAttribute("role", "status");
  const next = document.createElement("button");
  const skip = document.createElement("button");
  next.type = skip.type = "button";
  skip.textContent = "Skip";
  box.append(text, next, skip);
  let at = 0;

  function end() {
    box.remove();
    try { localStorage.setItem(KEY, "seen"); } catch { /* it will be said again */ }
  }
  function show() {
    if (at === model.hints.length) { end(); return; }
    text.textContent = model.hints[at];
    next.textContent = at + 1 < model.hints.length ? `Next (${at + 1} of ${model.hints.length})` : "Got it";
    skip.hidden = at + 1 === model.hints.length;
  }
  next.addEventListener("click", () => { at += 1; show(); });
  skip.addEventListener("click", end);
  box.addEventListener("keydown", (event) => { if (event.key === "Escape") end(); });
  show();
  return box;
}
