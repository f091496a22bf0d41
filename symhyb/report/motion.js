"use strict";
// plays the drawing of a machine: shapes of SVG that are moved along instants of a recording
(function () {
  const { t, seconds, seen, moves } = JSON.parse(document.getElementById("motion").textContent);
  const figure = document.querySelector("figure.motion");
  const button = figure.querySelector("button"), slider = figure.querySelector("input");
  const clock = figure.querySelector(".clock"), ghost = figure.querySelector(".ghost");
  const last = t.length - 1;
  const shapes = [...figure.querySelectorAll("svg [points], svg circle, svg text")];

  function placesOf([size, ...steps]) {
    const places = Float32Array.from(steps);
    for (let i = size; i < places.length; i++) places[i] += places[i - size];
    return { size, places };
  }

  const moving = moves
    .map((move, i) => ({ shape: shapes[i], ...placesOf(move) }))
    .filter(({ size }) => size > 0);
  let at = 0, playing = false, before = 0;

  function show(now) {
    at = Math.max(0, Math.min(now, last));
    const i = Math.min(Math.floor(at), last - 1), part = at - i;
    for (const { shape, size, places } of moving) {
      const values = [];
      for (let k = i * size; k < (i + 1) * size; k++) {
        values.push((places[k] + part * (places[k + size] - places[k])).toFixed(1));
      }
      if (size === 2) shape.setAttribute("transform", `translate(${values})`);
      else shape.setAttribute("points", values.join(" "));
    }
    ghost.setAttribute("visibility", Math.ceil(at) < seen ? "visible" : "hidden");
    const time = `${(t[i] + part * (t[i + 1] - t[i])).toPrecision(4)} s`;
    clock.textContent = time;
    slider.value = at;
    slider.setAttribute("aria-valuetext", time);
  }

  function turn(on) {
    playing = on;
    button.textContent = on ? "❚❚ pause" : "▶ play";
    if (!on) return;
    if (at >= last) show(0);
    before = performance.now();
    requestAnimationFrame(step);
  }

  function step(now) {
    if (!playing) return;
    show(at + (Math.max(now - before, 0) / 1000) * (last / seconds));
    before = now;
    if (at < last) requestAnimationFrame(step);
    else turn(false);
  }

  button.addEventListener("click", () => turn(!playing)); // it never begins by itself
  slider.addEventListener("input", () => { turn(false); show(Number(slider.value)); });
  slider.max = last;
  show(0);
  figure.hidden = false;
  document.documentElement.dataset.motion = "ready";
})();
