(function () {
  const { items, dark } = JSON.parse(document.getElementById("figures").textContent);
  const { scheme, paint } = painter(dark);

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
