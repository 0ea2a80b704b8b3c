// At each painting Bokeh writes anew where every renderer is, moved or not, and asks for computed
// styles in between, which the browser then works out for the whole page: half of a move's time.
// Here only what differs is written. All figures share the one prototype.
if (!figure.keeps_styles) { // finding a view takes looking at all of them: once
  const [renderer] = cb_context.index.get_one(figure).renderer_views.values();
  const sheet = Object.getPrototypeOf(renderer.position);
  if (!Object.hasOwn(sheet, "keeps")) {
    const write = sheet._update;
    sheet._update = function (css) {
      if (css !== this.css) write.call(this, css);
    };
    sheet.keeps = true;
  }
  figure.keeps_styles = true;
}
