(function () {
  const { scheme, paint } = painter(JSON.parse(document.getElementById("colours").textContent));

  function models() {
    return new Set(Bokeh.documents.flatMap((one) => one.roots()).flatMap((root) => [...root.references()]));
  }

  let waiting = false;
  function repaint() {
    if (waiting) return;
    waiting = true;
    setTimeout(() => { waiting = false; paint(models()); }, 0);
  }

  function watch(page) {
    page.on_change((event) => { if (["children", "tabs"].includes(event.attr)) repaint(); });
    page.on_event("connection_lost", () => { document.getElementById("gone").hidden = false; });
    scheme.addEventListener("change", repaint);
    paint(models());
    document.documentElement.dataset.drawn = "";
  }

  const begun = setInterval(() => {
    const [page] = window.Bokeh?.documents ?? [];
    if (!page || !page.roots().length) return;
    clearInterval(begun);
    watch(page);
  }, 20);
})();
