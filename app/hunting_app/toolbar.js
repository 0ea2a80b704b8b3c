// Undo and redo, the baseline, files and the link; the server does what the buttons say.

export function render({ model }) {
  const box = element("div", { class: "tools", role: "toolbar", "aria-label": "edit and share" });
  const act = sender(model, box);
  const button = (label, title, onclick, attributes = {}) => element("button",
    { type: "button", title, onclick, ...attributes }, label);

  const undo = button("↶ Undo", "", () => act({ undo: true }), { "aria-keyshortcuts": "Control+Z" });
  const redo = button("↷ Redo", "", () => act({ redo: true }), { "aria-keyshortcuts": "Control+Shift+Z" });
  const pin = button("Pin as baseline", "Keep these curves in grey and show every answer's change against them",
    () => act({ pin: true }));
  const unpin = button("Unpin", "", () => act({ pin: false }));
  const file = element("input", {
    type: "file", accept: ".json,application/json", hidden: true, "aria-hidden": "true", tabindex: "-1",
    onchange: () => { open(file.files); file.value = ""; },
  });
  const load = button("Open…", "Open parameters or designs from a JSON file; or drop one on the page", () => file.click());
  const save = button("Save file", "Save the parameters as a JSON file", () => act({ save: true }));
  const copy = button("Copy link", "Copy a link that opens what is shown now, baseline included", copyLink);
  const notices = element("div", { class: "notices", role: "alert" });
  const said = element("div", { class: "said", role: "status" });
  const target = element("div", { class: "target" }, "Drop a JSON file to open its parameters");
  box.append(undo, redo, pin, unpin, load, save, model.served ? copy : "", file);

  function show() {
    for (const [node, what, verb] of [[undo, model.undo, "Undo"], [redo, model.redo, "Redo"]]) {
      node.disabled = !what;
      const keys = verb === "Undo" ? "Ctrl+Z" : "Ctrl+Shift+Z";
      node.title = what ? `${verb}: ${what} (${keys})` : `Nothing to ${verb.toLowerCase()} (${keys})`;
    }
    pin.disabled = !model.pinnable;
    unpin.hidden = !model.pinned;
    unpin.textContent = model.baseline ? `Unpin ${model.baseline}` : "Unpin";
    unpin.title = "Take the baseline's grey curves away";
  }
  function notice() {
    notices.replaceChildren(...model.notices.map((text) => element("p", {}, text)));
    if (model.notices.length) notices.append(button("Dismiss", "", () => act({ dismiss: true })));
  }
  let silence;
  function say(text) {
    said.textContent = text;
    clearTimeout(silence);
    silence = setTimeout(() => { said.textContent = ""; }, 6000);
  }

  // What is under way ends first, so that the link holds it.
  let copying = false;
  function copyLink() {
    copying = true;
    act({ rest: true });
  }
  model.on("answered", async () => {
    if (!copying || box.dataset.busy === "yes") return;
    copying = false;
    try {
      await navigator.clipboard.writeText(window.location.href);
      say("Link copied: it opens what is shown now.");
    } catch { // no permission, or a page that is not served by https
      window.prompt("This browser does not let the page copy. The link:", window.location.href);
    }
  });

  const tooLarge = (one) => one.size > 4 * model.largest; // characters have up to four bytes
  async function open(found) {
    if (found.length !== 1) { say("Drop one file at a time."); return; }
    const [one] = found;
    act({ file: one.name, size: one.size, text: tooLarge(one) ? null : await one.text() });
  }

  /** In a notebook what happens elsewhere is none of ours. */
  const isOurs = (event) => model.served
    || event.composedPath().some((node) => node.classList?.contains("root"));
  function press(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isTyping(event) || !isOurs(event)) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    act(key === "y" || event.shiftKey ? { redo: true } : { undo: true });
  }
  const carriesFile = (event) => event.dataTransfer?.types.includes("Files") && isOurs(event);
  function drag(event) {
    if (!carriesFile(event)) return;
    event.preventDefault();
    target.classList.add("shown");
  }
  function leave(event) { if (event.relatedTarget === null) target.classList.remove("shown"); }
  function drop(event) {
    target.classList.remove("shown");
    if (!carriesFile(event)) return;
    event.preventDefault();
    open(event.dataTransfer.files);
  }
  const listeners = { keydown: press, dragover: drag, dragleave: leave, drop };
  for (const [name, listener] of Object.entries(listeners)) document.addEventListener(name, listener);
  model.on("remove", () => {
    for (const [name, listener] of Object.entries(listeners)) document.removeEventListener(name, listener);
  });

  for (const name of ["undo", "redo", "pinned", "baseline", "pinnable"]) model.on(name, show);
  model.on("notices", notice);
  model.on("said", () => say(model.said[0]));
  model.on("msg:custom", download);
  show();
  notice();
  return element("div", { class: "bar" }, box, notices, said, target);
}
