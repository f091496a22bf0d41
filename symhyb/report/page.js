"use strict";
(function () {
  const { items, dark } = JSON.parse(document.getElementById("figures").textContent);
  const light = Object.fromEntries(Object.entries(dark).map(([day, night]) => [night, day]));
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  const ink = "#1f2933", quiet = "#8a949e", grid = "#e6e9ec", ticks = "#4a5560";
  const drawn = { Title: { text_color: ink }, Figure: { border_fill_color: "#fffffe" }, Grid: { grid_line_color: grid } };
  drawn.LinearAxis = {
    axis_line_color: quiet, major_tick_line_color: quiet, minor_tick_line_color: null,
    major_label_text_color: ticks, axis_label_text_color: ink,
  };

  function inScheme(color) {
    return (scheme.matches ? dark[color] : light[color]) ?? color;
  }

  function paint(models) {
    for (const model of models) {
      const wanted = { ...drawn[model.type] };
      if (["Line", "VArea", "BoxAnnotation", "Span"].includes(model.type)) {
        for (const name of ["line_color", "fill_color"]) {
          const held = model[name];
          if (held !== undefined && held !== null) wanted[name] = held.value ?? held;
        }
      }
      for (const [name, color] of Object.entries(wanted)) {
        if (color !== null) wanted[name] = inScheme(color);
      }
      if (Object.keys(wanted).length) model.setv(wanted);
    }
  }

  function steer(box, models) {
    const range = models.find((model) => model.name === "time");
    const [low, high] = [range.start, range.end];
    const show = (start, end) => range.setv({
      start: Math.max(low, Math.min(start, end)), end: Math.min(high, Math.max(start, end)),
    });
    const moves = {
      in: (middle, half) => show(middle - half / 2, middle + half / 2),
      out: (middle, half) => show(middle - half * 2, middle + half * 2),
      back: (middle, half) => move(-half),
      on: (middle, half) => move(half),
      all: () => show(low, high),
    };
    function move(by) {
      const step = Math.max(low - range.start, Math.min(by, high - range.end));
      show(range.start + step, range.end + step);
    }
    for (const button of box.querySelectorAll("button")) {
      button.addEventListener("click", () => {
        moves[button.dataset.zoom]((range.start + range.end) / 2, (range.end - range.start) / 2);
      });
    }
    const said = box.querySelector(".span");
    const tell = () => {
      said.textContent = `${Number(range.start.toPrecision(5))} to ${Number(range.end.toPrecision(5))} s`;
    };
    range.change.connect(tell);
    tell();
    for (const tick of box.querySelectorAll("input")) {
      const lines = models.filter((model) => model.type === "GlyphRenderer" && model.name === tick.dataset.line);
      const turn = () => { for (const line of lines) line.visible = tick.checked; };
      tick.addEventListener("change", turn);
      turn();
    }
  }

  async function draw(item) {
    const box = document.getElementById(item.target_id).parentElement;
    const group = box.parentElement;
    group.classList.add("live"); // Bokeh measures the place, which must be seen
    try {
      await Bokeh.embed.embed_item(item);
      const models = [...Bokeh.documents.at(-1).roots()[0].references()];
      steer(box, models);
      paint(models);
      scheme.addEventListener("change", () => paint(models));
      group.dataset.drawn = "";
    } catch (error) {
      group.classList.remove("live"); // the still figures say the same
      delete document.documentElement.dataset.figures;
      console.error(error);
    }
  }

  const waiting = new Map(items.map((item) => [document.getElementById(item.target_id), item]));
  let last = Promise.resolve(); // one after the other: what is near the screen, then the rest
  function next(place) {
    const item = waiting.get(place);
    waiting.delete(place);
    if (item) last = last.then(() => draw(item));
    return last;
  }

  const near = new IntersectionObserver((seen) => {
    for (const { isIntersecting, target } of seen) {
      if (isIntersecting) next(target.closest(".recording").querySelector(".plots"));
    }
  }, { rootMargin: "600px" });
  document.documentElement.dataset.figures = "ready";
  for (const place of waiting.keys()) near.observe(place.closest(".recording"));

  const idle = window.requestIdleCallback ?? ((work) => setTimeout(work, 200));
  async function rest() {
    const [place] = waiting.keys();
    if (!place) return;
    await next(place);
    idle(rest);
  }
  idle(rest);
})();
