// At each painting Bokeh writes anew where every renderer's element is, moved or not, and asks for
// computed styles in between, which the browser then works out for the whole page: half of a move's
// time. Inside a frame these elements are empty, so they stay where they are; of axes, whose size
// does matter, only what differs is written. All figures share the prototypes.
// And it clears a canvas half a pixel off its upper and left edges, where the colours of the other
// scheme would stay as a line.
if (!figure.keeps_styles) { // finding a view takes looking at all of them: once
  const view = cb_context.index.get_one(figure);
  const [renderer] = view.renderer_views.values();
  const sheet = Object.getPrototypeOf(renderer.position);
  if (!Object.hasOwn(sheet, "keeps")) {
    let kind = Object.getPrototypeOf(renderer);
    while (!Object.hasOwn(kind, "update_position")) kind = Object.getPrototypeOf(kind);
    const { update_position: place } = kind;
    const { _update: write } = sheet;
    kind.update_position = function () {
      if (this.panel != null) place.call(this);
    };
    sheet._update = function (css) {
      if (css !== this.css) write.call(this, css);
    };
    Object.getPrototypeOf(view.canvas_view.primary).clear = function () {
      const { x, y, width, height } = this.bbox;
      this.ctx.clearRect(x - 1, y - 1, width + 2, height + 2);
    };
    sheet.keeps = true;
  }
  figure.keeps_styles = true;
}
