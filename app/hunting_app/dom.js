// What components share: elements, downloads, and messages that are waited for.

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value != null) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child != null));
  return made;
}

/** Let the browser save a text as a file. */
function download({ name, text, type }) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = element("a", { href: url, download: name });
  document.body.append(link); // Firefox follows only links of the page
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** Return what sends an act; the box says whether an answer is still to come. */
function sender(model, box) {
  let number = model.answered;
  box.dataset.busy = "no";
  model.on("answered", () => { if (model.answered === number) box.dataset.busy = "no"; });
  return (act) => {
    number += 1;
    box.dataset.busy = "yes";
    model.send_msg({ act, number });
  };
}

/** Whether an event happened in a box that text is typed into: its keys are the box's own. */
function isTyping(event) {
  const node = event.composedPath()[0];
  if (!(node instanceof Element)) return false;
  if (node.matches("input")) return !/^(range|radio|checkbox|button|submit|file)$/.test(node.type);
  return node.matches("textarea, select") || node.isContentEditable;
}
