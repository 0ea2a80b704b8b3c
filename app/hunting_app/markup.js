// Shows model.html; a click on an element with data-act sends that JSON to the server.
export function render({ model }) {
  const box = document.createElement("div");
  const show = () => { box.innerHTML = model.html; };
  box.addEventListener("click", (event) => {
    const button = event.target.closest("[data-act]");
    if (button) model.send_msg(JSON.parse(button.dataset.act));
  });
  model.on("html", show);
  show();
  return box;
}
