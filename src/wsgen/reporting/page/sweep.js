// The script of the page of a sweep, after `common.js`: its chart, and pages light and dark.

// Of each group of runs the place in `palette()`, and a symbol: passed, four rules, all others.
const PLACES = [0, 3, 1, 4, 2, 7];
const SYMBOLS = ["circle", "x", "triangle-up", "square", "diamond", "cross"];
const NARROW = 560; // CSS pixels
const MARK = 0.35; // opacity of a cell below its symbol
const FEW_CELLS = 45; // along an axis: each has its symbol

const chartData = once(async () => {
  const buffer = await unpack("data");
  return JSON.parse(new TextDecoder().decode(buffer));
});

function groupColor(number) {
  return palette()[PLACES[number]];
}

function faded(hex, opacity) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  return `rgba(${red},${green},${blue},${opacity})`;
}

// An axis of a plot from what the chart says of it; `margin` is a share of its range.
function scaled(one, margin, more = {}) {
  const ends = one.is_log ? [Math.log10(one.low), Math.log10(one.high)] : [one.low, one.high];
  const span = ends[1] - ends[0];
  const ticks = one.ticks.length
    ? { tickvals: one.ticks.map(([at]) => at), ticktext: one.ticks.map(([, text]) => shown(text)) }
    : {};
  return axis(shown(one.label), {
    type: one.is_log ? "log" : "linear",
    range: [ends[0] - margin * span, ends[1] + margin * span],
    ...(one.is_log ? { dtick: span < 1.2 ? undefined : 1 } : {}),
    ...ticks,
    ...more,
  });
}

function groupTraces(chart, panel, size) {
  return panel.points.map((points) => {
    const group = chart.groups.find((one) => one.number === points.group);
    return {
      type: "scatter",
      mode: "markers",
      x: points.x,
      y: points.y,
      customdata: points.runs,
      name: shown(`${group.name} (${group.runs.toLocaleString("en")})`),
      marker: {
        color: groupColor(points.group),
        symbol: SYMBOLS[points.group],
        size,
        line: { width: 0.5, color: color("card") },
      },
      hovertemplate: "run %{customdata}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
    };
  });
}

function shareTraces(panel) {
  const main = palette()[0];
  const common = { x: panel.line_x, y: panel.line_y, hovertemplate: "%{y:.1f} %<extra></extra>" };
  const interval = panel.line_low.length
    ? {
        error_y: {
          type: "data",
          symmetric: false,
          array: panel.line_high.map((high, index) => high - panel.line_y[index]),
          arrayminus: panel.line_low.map((low, index) => panel.line_y[index] - low),
          color: color("muted"),
          thickness: 1.2,
          width: 3,
        },
      }
    : {};
  return [
    panel.is_bars
      ? { ...common, ...interval, type: "bar", width: 0.6, marker: { color: main } }
      : {
          ...common,
          ...interval,
          type: "scatter",
          mode: "lines+markers",
          line: { color: main, width: 2 },
          marker: { color: main, size: 6 },
        },
  ];
}

function markShapes(panel) {
  return panel.marks.flatMap((mark) => [
    {
      type: "rect",
      yref: "paper",
      x0: mark.low,
      x1: mark.high,
      y0: 0,
      y1: 1,
      layer: "below",
      line: { width: 0 },
      fillcolor: color("note-back"),
    },
    {
      type: "line",
      yref: "paper",
      x0: mark.at,
      x1: mark.at,
      y0: 0,
      y1: 1,
      line: { color: color("text"), width: 1.5, dash: "dash" },
    },
  ]);
}

function drawPanel(chart, plot, panel) {
  // Texts below a narrow plot are turned, and long.
  plot.style.height = panel.x.is_text && plot.clientWidth < NARROW ? "19rem" : "";
  const count = panel.points.reduce((sum, points) => sum + points.x.length, 0);
  const size = count < 400 ? 8 : count < 1200 ? 6 : 4;
  const traces = panel.line_x.length ? shareTraces(panel) : groupTraces(chart, panel, size);
  return [
    traces,
    layout({
      xaxis: scaled(panel.x, 0.02),
      // Of several plots the heading has the label, which may be long.
      yaxis: scaled(panel.y, 0.05, chart.panels.length > 1 ? { title: { text: "" } } : {}),
      shapes: markShapes(panel),
      showlegend: false,
      hovermode: "closest",
    }),
  ];
}

function drawCells(chart, plot, cells) {
  const base = { type: "heatmap", x: cells.x_edges, y: cells.y_edges };
  const axes = { xaxis: scaled(cells.x, 0), yaxis: scaled(cells.y, 0), showlegend: false };
  if (cells.shares.length) {
    const bar = { title: { text: "passed, %", side: "right" }, thickness: 14, outlinewidth: 0 };
    const traces = [
      {
        ...base,
        z: cells.shares,
        zmin: 0,
        zmax: 100,
        colorscale: "Cividis",
        hoverongaps: false,
        colorbar: bar,
        hovertemplate: "%{z:.1f} % passed<br>%{x:.4g}, %{y:.4g}<extra></extra>",
      },
    ];
    return [traces, layout(axes)];
  }
  const steps = PLACES.flatMap((_, number) => {
    const shade = faded(groupColor(number), MARK);
    return [
      [number / PLACES.length, shade],
      [(number + 1) / PLACES.length, shade],
    ];
  });
  const nameOf = new Map(chart.groups.map((group) => [group.number, shown(group.name)]));
  const xs = cells.x_values;
  const ys = cells.y_values;
  const traces = [
    {
      ...base,
      xgap: 0.5,
      ygap: 0.5,
      z: cells.groups.map((row) => row.map((number) => (number < 0 ? null : number))),
      zmin: -0.5,
      zmax: PLACES.length - 0.5,
      colorscale: steps,
      showscale: false,
      hoverongaps: false,
      text: cells.groups.map((row) => row.map((number) => nameOf.get(number) ?? "")),
      hovertemplate: "%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
    },
  ];
  const most = Math.max(xs.length, ys.length);
  if (most <= FEW_CELLS) {
    const size = Math.max(3, Math.min(10, (0.35 * plot.clientWidth) / most));
    for (const group of chart.groups) {
      const places = cells.groups.flatMap((row, y) =>
        row.flatMap((number, x) => (number === group.number ? [[xs[x], ys[y]]] : [])),
      );
      traces.push({
        type: "scatter",
        mode: "markers",
        x: places.map(([x]) => x),
        y: places.map(([, y]) => y),
        marker: { color: groupColor(group.number), symbol: SYMBOLS[group.number], size },
        hoverinfo: "skip",
      });
    }
  }
  return [traces, layout(axes)];
}

// Axes stand side by side; on a narrow page they lie below each other.
function drawParallel(chart, plot) {
  const isNarrow = plot.clientWidth < NARROW;
  const count = chart.lines.reduce((sum, lines) => sum + lines.places.length, 0);
  const opacity = Math.max(0.15, Math.min(0.8, 60 / Math.max(count, 1)));
  const last = chart.axes.length - 1;
  const at = (number) => (isNarrow ? last - number : number);
  const traces = chart.lines.map((lines) => {
    const along = lines.places.flatMap((run) => [...run, null]);
    const across = lines.places.flatMap((run) => [...run.map((_, number) => at(number)), null]);
    const [x, y] = isNarrow ? [along, across] : [across, along];
    return {
      type: "scatter",
      mode: "lines",
      x,
      y,
      opacity,
      line: { color: groupColor(lines.group), width: 1.2 },
      hoverinfo: "skip",
    };
  });
  const place = (number, value) => (isNarrow ? { x: value, y: at(number) } : { x: at(number), y: value });
  const plain = { showarrow: false, font: { size: 11, color: color("text") } };
  const ticks = chart.axes.flatMap((one, number) => {
    const shownTicks = isNarrow && one.labels.length > 3
      ? one.labels.filter((_, index) => index % Math.ceil(one.labels.length / 3) === 0)
      : one.labels;
    return shownTicks.map(([value, text]) => ({
      ...plain,
      ...place(number, value),
      text: shown(text),
      bgcolor: faded(color("card"), 0.75),
      ...(isNarrow ? { yshift: -9 } : { xanchor: "left", xshift: 3 }),
    }));
  });
  const names = chart.axes.map((one, number) => ({
    ...plain,
    ...place(number, isNarrow ? 0 : 1),
    text: `<b>${shown(one.label)}</b>`,
    ...(isNarrow ? { xanchor: "left", yshift: 11 } : { yshift: 26, textangle: 0 }),
  }));
  const shapes = chart.axes.map((_, number) => ({
    type: "line",
    ...(isNarrow
      ? { x0: 0, x1: 1, y0: at(number), y1: at(number) }
      : { x0: at(number), x1: at(number), y0: 0, y1: 1 }),
    line: { color: color("text"), width: 1.2 },
  }));
  const none = { visible: false, fixedrange: true };
  const along = { ...none, range: isNarrow ? [-0.1, 1.1] : [-0.05, 1.05] };
  const across = { ...none, range: isNarrow ? [-0.35, last + 0.4] : [-0.2, last + 0.35] };
  return [
    traces,
    layout({
      xaxis: isNarrow ? along : across,
      yaxis: isNarrow ? across : along,
      annotations: [...ticks, ...names],
      shapes,
      showlegend: false,
      margin: isNarrow ? { l: 4, r: 4, t: 8, b: 8 } : { l: 30, r: 30, t: 40, b: 10 },
    }),
  ];
}

async function drawChart() {
  const plots = [...document.querySelectorAll(".chart")];
  try {
    const chart = await chartData("data");
    const Plotly = await plotly("plotly");
    for (const swatch of document.querySelectorAll(".swatch")) {
      swatch.style.color = groupColor(Number(swatch.dataset.group));
    }
    for (const [number, plot] of plots.entries()) {
      const [traces, look] = chart.axes.length
        ? drawParallel(chart, plot)
        : chart.cells
          ? drawCells(chart, plot, chart.cells)
          : drawPanel(chart, plot, chart.panels[number]);
      await Plotly.react(plot, traces, look, CONFIG);
      plot.dataset.drawn = "1";
      await pause();
    }
  } catch (error) {
    for (const plot of plots.filter((one) => !one.dataset.drawn)) {
      plot.textContent = `This browser cannot show the plot: ${error.message ?? error}`;
    }
  }
}

drawChart();
dark.addEventListener("change", drawChart);
window.matchMedia(`(max-width: ${NARROW}px)`).addEventListener("change", drawChart);
