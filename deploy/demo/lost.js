// The connection was lost. The address bar holds the values, so a page loaded anew from any server
// goes on with them; until one answers, say so.
export default async function () {
  const notice = document.createElement("p");
  notice.setAttribute("role", "alert");
  notice.textContent = "The connection to the server was lost. Your values are in the address bar: "
    + "this page goes on with them as soon as a server answers.";
  notice.style.cssText = "position: fixed; inset: auto 0 0 0; z-index: 10000; margin: 0;"
    + "padding: 0.8em 1em; font: 1em system-ui; background: #7a1f1f; color: white";
  document.body.append(notice);

  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const answers = () => fetch(new URL("liveness", window.location.href), { cache: "no-store" })
    .then((response) => response.ok, () => false);

  // Not all at once: a server that takes over many visitors starts a session for each.
  await wait(500 + 2500 * Math.random());
  while (!await answers()) await wait(2000);
  window.location.reload();
}
