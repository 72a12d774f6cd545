"use strict";
// What the scripts of all pages share: packed data, plotly.js, colors and the looks of plots.

// ---- Packed data: see page_data.py.

async function unpack(id) {
  const element = document.getElementById(id);
  const bytes = Uint8Array.from(atob(element.textContent), (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

function once(task) {
  const known = new Map();
  return (key) => {
    if (!known.has(key)) known.set(key, task(key));
    return known.get(key);
  };
}

const plotly = once(async () => {
  const code = new TextDecoder().decode(await unpack("plotly"));
  await pause(); // the page answers in between
  const script = document.createElement("script");
  script.textContent = code;
  document.head.append(script);
  return window.Plotly;
});

function pause() {
  return new Promise((resolve) => setTimeout(resolve));
}

// ---- Colors: those of the page, light or dark.

const dark = window.matchMedia("(prefers-color-scheme: dark)");

function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// Okabe and Ito's colors, which color-blind people distinguish; lighter ones on a dark page.
function palette() {
  return dark.matches
    ? ["#6cb8ee", "#f2b134", "#4fd1a5", "#f08a5d", "#dd9fc7", "#f0e26b", "#9fb4ff", "#c7ccd3"]
    : ["#0072b2", "#b86e00", "#008763", "#c44a00", "#a94f86", "#6b6200", "#4453c4", "#555d66"];
}

function shown(text) {
  // Plotly takes tags in texts for markup.
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

// ---- The looks of plots.

const CONFIG = { displaylogo: false, responsive: true, displayModeBar: false };

function axis(title, more = {}) {
  return {
    title: { text: title, standoff: 6, font: { size: 12 } },
    gridcolor: color("line"),
    linecolor: color("line"),
    zeroline: false,
    automargin: true,
    ...more,
  };
}

function layout(more) {
  return {
    font: { family: getComputedStyle(document.body).fontFamily, color: color("text"), size: 12 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    colorway: palette(),
    margin: { l: 48, r: 12, t: 8, b: 40 },
    hoverlabel: { font: { size: 12 }, namelength: -1 },
    ...more,
  };
}
