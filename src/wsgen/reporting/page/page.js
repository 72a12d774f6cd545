// The script of a report, after `common.js`: tables that sort, plots and 3D views that are drawn when
// they are seen.

const dataOf = once(async (number) => {
  const buffer = await unpack(`data-${number}`);
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { header, buffer, start: 4 + length };
});

function column(data, one) {
  const levels = new Uint16Array(data.buffer, data.start + one.at, one.n);
  return Array.from(levels, (level) => one.low + one.step * level);
}

// ---- Plots over time.

const ENGINES = { bullet: "PyBullet", mujoco: "MuJoCo", dart: "DART" };
const DASHES = ["solid", "dash", "dot"];
const MOST_JOINTS = 10; // that are drawn before somebody chooses in the legend

function range(joint) {
  return joint.step * 65535;
}

function lines(kind, data, all) {
  const colors = palette();
  const several = all.length > 1;
  return all.flatMap((series, number) => {
    const seconds = column(data, series.seconds);
    const engine = ENGINES[series.engine];
    const dash = DASHES[number % DASHES.length];
    if (kind === "angles" || kind === "slides") {
      const joints = series.joints.filter((joint) => joint.slides === (kind === "slides"));
      return joints.map((joint, index) => ({
        x: seconds,
        y: column(data, joint),
        name: shown(several ? `${joint.name} (${engine})` : joint.name),
        visible: index < MOST_JOINTS ? true : "legendonly",
        mode: "lines",
        line: { width: 2, dash, color: colors[index % colors.length] },
      }));
    }
    const line = { width: 2, dash, color: colors[number % colors.length] };
    const values = { x: seconds, name: engine, mode: "lines", line, showlegend: several };
    if (kind === "path") {
      const path = { ...values, x: column(data, series.x), y: column(data, series.y) };
      return [...(number === 0 ? area(data, series.goal) : []), path, ...ends(path, number)];
    }
    return [{ ...values, y: column(data, series[kind]) }];
  });
}

// Where a behavior has to end: the same in all engines.
function area(data, goal) {
  if (!goal) return [];
  return [
    {
      x: column(data, goal.x),
      y: column(data, goal.y),
      name: "has to end here",
      mode: "lines",
      fill: "toself",
      fillcolor: color("good-back"),
      line: { width: 1.5, color: color("good"), dash: "dot" },
      hoverinfo: "name",
    },
  ];
}

function ends({ x, y, line }, number) {
  const marker = (at, name, symbol) => ({
    x: [x.at(at)],
    y: [y.at(at)],
    name,
    mode: "markers",
    showlegend: number === 0,
    marker: { size: 11, symbol, color: line.color, line: { width: 1.5, color: color("card") } },
  });
  return [marker(0, "start", "circle"), marker(-1, "end", "square")];
}

// A line of noise is flat: an axis shows no less than this.
const LEAST = { height: 0.01, speed: 0.05, tilt: 1, angles: 0.05, slides: 0.005 };

function spread(traces, kind) {
  const values = traces.filter((one) => one.visible !== "legendonly").flatMap((one) => one.y);
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  const missing = LEAST[kind] - (high - low);
  if (!(missing > 0)) return {};
  const isPositive = kind === "speed" || kind === "tilt";
  return isPositive
    ? { range: [-0.04 * LEAST[kind], LEAST[kind]] }
    : { range: [low - missing / 2, high + missing / 2] };
}

const UNITS = { height: "m", speed: "m/s", tilt: "degrees", angles: "rad", slides: "m" };

async function drawMotion(motion) {
  const status = motion.querySelectorAll(".plot");
  const data = await dataOf(motion.dataset.package);
  const Plotly = await plotly("plotly");
  const robot = data.header.robots[motion.dataset.robot];
  const phases = [...new Set(robot.series.map((one) => one.behavior))];
  const select = motion.querySelector("select");
  const phase = phases[select ? Number(select.value) : 0];
  const all = robot.series.filter((one) => one.behavior === phase);
  for (const plot of status) {
    const kind = plot.dataset.kind;
    const figure = plot.closest("figure");
    if (kind === "path") figure.hidden = phase === null;
    figure.querySelector(".said").hidden = phase !== phases[0];
    if (figure.hidden) continue;
    const traces = lines(kind, data, all);
    const isNarrow = plot.clientWidth < 560;
    const legend = isNarrow || kind === "path"
      ? { orientation: "h", x: 0, y: -0.25, yanchor: "top" }
      : { orientation: "v", x: 1.01, y: 1 };
    const axes =
      kind === "path"
        ? { xaxis: axis("x, m"), yaxis: axis("y, m", { scaleanchor: "x" }) }
        : { xaxis: axis("time, s"), yaxis: axis(UNITS[kind], spread(traces, kind)) };
    const hovermode = kind === "path" ? "closest" : "x unified";
    if (isNarrow && traces.length > 4) {
      plot.style.height = `${17 + Math.min(traces.length, 30)}rem`;
    }
    await Plotly.react(plot, traces, layout({ ...axes, legend, hovermode }), CONFIG);
    plot.dataset.drawn = "1";
    await pause();
  }
}

// ---- 3D views.

const MOST_VIEWS = 4; // at a time: browsers have few contexts for 3D
const EYES = { front: [1.6, 0, 0.2], side: [0, -1.6, 0.2], top: [0.01, 0, 1.8] };
const HOME = [0.98, -1.08, 0.62]; // as the picture is seen
const views = [];

function surface(data, part) {
  const levels = new Uint16Array(data.buffer, data.start + part.corners.at, part.corners.n);
  const Numbers = part.triangles.wide ? Uint32Array : Uint16Array;
  const corners = new Numbers(data.buffer, data.start + part.triangles.at, part.triangles.n);
  const every = (array, first, low, step) =>
    Float32Array.from({ length: array.length / 3 }, (_, index) => low + step * array[3 * index + first]);
  const numbers = (first) =>
    Uint32Array.from({ length: corners.length / 3 }, (_, index) => corners[3 * index + first]);
  const [red, green, blue, alpha] = part.rgba;
  const level = (value) => Math.round(255 * value);
  return {
    type: "mesh3d",
    x: every(levels, 0, part.low[0], part.step[0]),
    y: every(levels, 1, part.low[1], part.step[1]),
    z: every(levels, 2, part.low[2], part.step[2]),
    i: numbers(0),
    j: numbers(1),
    k: numbers(2),
    color: `rgb(${level(red)},${level(green)},${level(blue)})`,
    opacity: alpha < 0.95 ? alpha : 1,
    flatshading: !part.round,
    name: shown(`${part.entity}: ${part.link}`),
    hovertemplate: `${shown(part.link)}<extra>${shown(part.entity)}</extra>`,
    lighting: {
      ambient: 0.62,
      diffuse: 0.55,
      specular: 0.12,
      roughness: 0.6,
      fresnel: 0.05,
      facenormalsepsilon: 0,
      vertexnormalsepsilon: 0,
    },
    lightposition: { x: 3000, y: -9000, z: 14000 },
  };
}

function bounds(parts) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const part of parts) {
    for (const side of [0, 1, 2]) {
      low[side] = Math.min(low[side], part.low[side]);
      high[side] = Math.max(high[side], part.low[side] + 65535 * part.step[side]);
    }
  }
  return { low, high };
}

function ground(view) {
  const robots = view.parts.filter((part) => part.robot);
  const { low, high } = bounds(robots.length ? robots : view.parts);
  const size = Math.max(...[0, 1, 2].map((side) => high[side] - low[side]));
  const { tile } = view;
  const around = [0, 1].map((side) => [
    Math.floor((low[side] - 0.2 * size) / tile) * tile,
    Math.ceil((high[side] + 0.2 * size) / tile) * tile,
  ]);
  const [[left, right], [near, far]] = around;
  const x = [];
  const y = [];
  for (let at = left; at <= right + tile / 2; at += tile) {
    x.push(at, at, null);
    y.push(near, far, null);
  }
  for (let at = near; at <= far + tile / 2; at += tile) {
    x.push(left, right, null);
    y.push(at, at, null);
  }
  const plain = { hoverinfo: "skip", showlegend: false };
  const below = -0.002 * size;
  return [
    {
      ...plain,
      type: "mesh3d",
      x: [left, right, right, left],
      y: [near, near, far, far],
      z: [below, below, below, below],
      i: [0, 0],
      j: [1, 2],
      k: [2, 3],
      color: color("ground"),
      lighting: { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 },
    },
    {
      ...plain,
      type: "scatter3d",
      mode: "lines",
      x,
      y,
      z: x.map((at) => (at === null ? null : 0)),
      line: { color: color("grid"), width: 1.5 },
    },
  ];
}

function eye([x, y, z]) {
  return { eye: { x, y, z }, up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: -0.05 } };
}

async function drawView(scene) {
  const data = await dataOf(scene.dataset.package);
  const Plotly = await plotly("plotly");
  const { view } = data.header;
  const none = { visible: false, showspikes: false };
  const traces = view.parts.map((part) => surface(data, part));
  if (view.ground) traces.push(...ground(view));
  const camera = scene.layout?.scene?.camera ?? eye(HOME);
  await Plotly.react(
    scene,
    traces,
    layout({
      margin: { l: 0, r: 0, t: 0, b: 0 },
      showlegend: false,
      scene: {
        aspectmode: "data",
        camera,
        dragmode: "turntable",
        bgcolor: "rgba(0,0,0,0)",
        xaxis: none,
        yaxis: none,
        zaxis: none,
      },
    }),
    CONFIG,
  );
}

function closeView(figure) {
  const scene = figure.querySelector(".scene");
  window.Plotly?.purge(scene);
  scene.hidden = true;
  show(figure, false);
  const index = views.indexOf(figure);
  if (index >= 0) views.splice(index, 1);
}

function show(figure, isOpen) {
  const button = figure.querySelector(".turn");
  button.setAttribute("aria-pressed", String(isOpen));
  figure.querySelector(".sides").hidden = !isOpen;
}

async function openView(figure) {
  const scene = figure.querySelector(".scene");
  const status = figure.querySelector(".status");
  status.textContent = "Loading the 3D view …";
  status.hidden = false;
  show(figure, true);
  views.push(figure);
  if (views.length > MOST_VIEWS) closeView(views[0]);
  await pause();
  try {
    scene.hidden = false;
    await drawView(scene);
    status.hidden = true;
  } catch (error) {
    closeView(figure);
    status.textContent = `This browser cannot show the 3D view: ${error.message ?? error}`;
  }
}

function turn(scene, angle) {
  const { x, y, z } = scene.layout.scene.camera.eye;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return window.Plotly.relayout(scene, {
    "scene.camera": eye([cos * x - sin * y, sin * x + cos * y, z]),
  });
}

for (const figure of document.querySelectorAll(".view")) {
  const scene = figure.querySelector(".scene");
  if (!scene) continue;
  figure.querySelector(".turn").addEventListener("click", () => {
    if (scene.hidden) openView(figure);
    else closeView(figure);
  });
  figure.querySelector(".sides").addEventListener("click", (event) => {
    const { turn: way, side } = event.target.dataset;
    if (way) turn(scene, (Number(way) * Math.PI) / 8);
    if (side) window.Plotly.relayout(scene, { "scene.camera": eye(EYES[side]) });
  });
}

// ---- What is drawn when it is seen.

async function draw(motion) {
  try {
    await drawMotion(motion);
  } catch (error) {
    for (const plot of motion.querySelectorAll(".plot:not([data-drawn])")) {
      plot.textContent = `This browser cannot show the plot: ${error.message ?? error}`;
    }
  }
}

const motions = document.querySelectorAll(".motion");
const seen = new IntersectionObserver(
  (entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      seen.unobserve(entry.target);
      draw(entry.target);
    }
  },
  { rootMargin: "300px" },
);
for (const motion of motions) {
  seen.observe(motion);
  motion.querySelector("select")?.addEventListener("change", () => draw(motion));
}
dark.addEventListener("change", () => {
  for (const motion of motions) {
    if (motion.querySelector("[data-drawn]")) draw(motion);
  }
  for (const figure of views) drawView(figure.querySelector(".scene"));
});

// ---- Tables.

function key(row, index) {
  const cell = row.cells[index];
  const text = cell.dataset.value ?? cell.textContent.trim();
  const number = Number(text);
  return text !== "" && !Number.isNaN(number) ? number : text;
}

function compare(one, other) {
  if (typeof one === "number" && typeof other === "number") return one - other;
  if (typeof one !== typeof other) return typeof one === "number" ? -1 : 1;
  return one.localeCompare(other, undefined, { numeric: true });
}

for (const table of document.querySelectorAll("table.sortable")) {
  const headings = [...table.tHead.rows[0].cells];
  table.tHead.addEventListener("click", (event) => {
    const heading = event.target.closest("th");
    if (!event.target.closest("button")) return;
    const isUp = heading.getAttribute("aria-sort") !== "ascending";
    for (const other of headings) other.setAttribute("aria-sort", "none");
    heading.setAttribute("aria-sort", isUp ? "ascending" : "descending");
    const index = headings.indexOf(heading);
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row) => ({ row, value: key(row, index) }));
    rows.sort((one, other) => compare(one.value, other.value) * (isUp ? 1 : -1));
    body.append(...rows.map(({ row }) => row));
  });
}

// A table that does not fit shows each row as a list, with the name of the column before each cell.
const ROLES = { TABLE: "table", THEAD: "rowgroup", TBODY: "rowgroup", TR: "row", TD: "cell" };

function labelCells(table) {
  const names = [...table.tHead.rows[0].cells].map((heading) => heading.textContent.trim());
  for (const row of table.tBodies[0].rows) {
    [...row.cells].forEach((cell, index) => (cell.dataset.label = names[index]));
  }
  // Browsers take tables that are not laid out as such for none.
  for (const one of [table, ...table.querySelectorAll("thead, tbody, tr, td")]) {
    one.setAttribute("role", ROLES[one.tagName]);
  }
  for (const heading of table.querySelectorAll("th")) {
    heading.setAttribute("role", heading.scope === "col" ? "columnheader" : "rowheader");
  }
}

const widths = new ResizeObserver((entries) => {
  for (const { target, contentRect } of entries) {
    const table = target.querySelector("table");
    if (!contentRect.width || target.dataset.width === String(contentRect.width)) continue;
    target.dataset.width = contentRect.width;
    table.classList.remove("stacked");
    table.classList.toggle("stacked", target.scrollWidth > target.clientWidth);
  }
});
for (const scroll of document.querySelectorAll(".scroll")) {
  labelCells(scroll.querySelector("table"));
  widths.observe(scroll);
}

const filter = document.getElementById("only-failed");
filter?.addEventListener("change", () => {
  for (const row of document.querySelectorAll("[data-passed]")) row.hidden = filter.checked;
});
