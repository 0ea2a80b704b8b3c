// Title, pages, light or dark; and the address bar, which always holds the state.

export function render({ model }) {
  const box = document.createElement("header");
  const title = document.createElement("h1");
  title.textContent = "bogie hunting";
  const nav = document.createElement("nav");
  nav.setAttribute("aria-label", "pages");
  const buttons = new Map(model.pages.map(([key, label]) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.addEventListener("click", () => model.send_msg({ act: { page: key } }));
    nav.append(button);
    return [key, button];
  }));
  const theme = document.createElement("button");
  theme.type = "button";
  theme.className = "theme";
  theme.addEventListener("click", () => choose(!model.dark));
  box.append(title, nav, theme);

  function choose(dark) {
    document.cookie = `hunting-dark=${dark}; max-age=31536000; path=/; SameSite=Lax`;
    model.send_msg({ act: { dark } });
  }
  function showPage() {
    for (const [key, button] of buttons) {
      if (key === model.page) button.setAttribute("aria-current", "page");
      else button.removeAttribute("aria-current");
    }
  }
  function showTheme() {
    theme.textContent = model.dark ? "☀ Light" : "☾ Dark";
    theme.setAttribute("aria-label", model.dark ? "change to light colours" : "change to dark colours");
  }
  function writeAddress(change) {
    if (model.address === null || model.address === window.location.search) return;
    change.call(window.history, null, "", window.location.pathname + model.address + window.location.hash);
  }
  // While the server follows steps back or forward, the address is already further than it knows.
  let visited = model.visited;
  function goBack() {
    visited += 1;
    model.send_msg({ act: { link: window.location.search }, visited });
  }
  function arrive() {
    if (model.visited === visited) writeAddress(window.history.replaceState); // without what was refused
  }
  function edit() {
    if (model.visited === visited) writeAddress(window.history.pushState);
  }

  model.on("page", showPage);
  model.on("dark", showTheme);
  model.on("address", edit);
  model.on("visited", arrive);
  if (model.address !== null) {
    writeAddress(window.history.replaceState); // what was refused of a link does not stay in it
    window.addEventListener("popstate", goBack);
    model.on("remove", () => window.removeEventListener("popstate", goBack));
  }
  if (!/(^|; )hunting-dark=/.test(document.cookie)
      && window.matchMedia("(prefers-color-scheme: dark)").matches) choose(true);
  showPage();
  showTheme();
  return box;
}
