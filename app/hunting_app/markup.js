// Shows model.html; a click on an element with data-act sends that JSON to the server, what is
// typed into an input with data-asks is sent by that name.
export function render({ model, view }) {
  const box = document.createElement("div");
  const reachable = () => [...box.querySelectorAll("button, input")];
  const show = () => {
    const at = reachable().indexOf(box.getRootNode().activeElement);
    box.innerHTML = model.html;
    if (at >= 0) reachable()[at]?.focus(); // who is at the keyboard stays where they are
  };
  box.addEventListener("click", (event) => {
    const button = event.target.closest("[data-act]");
    if (button) model.send_msg(JSON.parse(button.dataset.act));
  });
  box.addEventListener("change", ({ target }) => {
    if (target.dataset.asks) model.send_msg({ [target.dataset.asks]: target.value });
  });
  if (model.scrolls) view.el.tabIndex = 0;
  model.on("html", show);
  show();
  return box;
}
