"use strict";
// colours of figures by Bokeh, which follow whether the reader's screen is light or dark
function painter(dark) {
  const light = Object.fromEntries(Object.entries(dark).map(([day, night]) => [night, day]));
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  const ink = "#1f2933", quiet = "#8a949e", grid = "#e6e9ec", ticks = "#4a5560";
  const drawn = { Title: { text_color: ink }, Figure: { border_fill_color: "#fffffe" }, Grid: { grid_line_color: grid } };
  drawn.LinearAxis = drawn.LogAxis = {
    axis_line_color: quiet, major_tick_line_color: quiet, minor_tick_line_color: null,
    major_label_text_color: ticks, axis_label_text_color: ink,
  };

  function inScheme(color) {
    return (scheme.matches ? dark[color] : light[color]) ?? color;
  }

  function paint(models) {
    for (const model of models) {
      const wanted = { ...drawn[model.type] };
      if (["Line", "Scatter", "VArea", "BoxAnnotation", "Span"].includes(model.type)) {
        for (const name of ["line_color", "fill_color"]) {
          const held = model[name];
          if (held !== undefined && held !== null) wanted[name] = held.value ?? held;
        }
      }
      for (const [name, color] of Object.entries(wanted)) {
        if (color !== null) wanted[name] = inScheme(color);
      }
      if (Object.keys(wanted).length) model.setv(wanted, { sync: false }); // a server need not know
    }
  }

  return { scheme, paint };
}
