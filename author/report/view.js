// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Draws a tool's figures when its section is first shown, and recolours the organ as its controls say.
"use strict";

const CONFIG = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d"] };
// matplotlib's magma from pale to dark, as the balls of held-out presses have it
const MAGMA = ["#fcfdbf", "#fec488", "#fb8861", "#e75263", "#b63679", "#812581", "#4f127b", "#1d1147", "#000004"]
  .map((colour, k, all) => [k / (all.length - 1), colour]);
const PLAIN = [[0, "#e9dcc3"], [1, "#e9dcc3"]];

function embedded(id) {
  const element = document.getElementById(id);
  return element ? JSON.parse(element.textContent) : null;
}

function numbers(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function draw(section) {
  if (section.dataset.drawn) return;
  section.dataset.drawn = "yes";
  for (const place of section.querySelectorAll(".figure")) {
    const figure = embedded(place.dataset.figure);
    const bar = place.classList.contains("organ");
    Plotly.newPlot(place, figure.data, figure.layout, { ...CONFIG, displayModeBar: bar }).then(() => {
      if (place.classList.contains("organ")) control(section, place);
    });
  }
}

function control(section, place) {
  const maps = embedded(section.dataset.maps);
  const values = maps.quantities.map((quantity) => numbers(quantity.values));
  const choice = section.querySelector("[data-role=quantity]");
  const level = section.querySelector("[data-role=depth]");
  const shown = section.querySelector("output");
  maps.quantities.forEach((quantity, k) => choice.add(new Option(quantity.name, quantity.key, k === 0, k === 0)));
  choice.add(new Option("nothing", ""));

  function colour() {
    const d = Number(level.value);
    shown.textContent = maps.depths[d] + " mm";
    const index = maps.quantities.findIndex((quantity) => quantity.key === choice.value);
    if (index < 0) {
      level.disabled = true;
      Plotly.restyle(place, { colorscale: [PLAIN], showscale: false }, [0]);
      return;
    }
    const quantity = maps.quantities[index];
    const vertices = values[index].length / quantity.levels;
    level.disabled = quantity.levels === 1; // one map for all depths
    shown.textContent = level.disabled ? "all depths" : shown.textContent;
    const part = level.disabled ? values[index] : values[index].slice(d * vertices, (d + 1) * vertices);
    let [low, high] = quantity.ends || [Infinity, -Infinity];
    if (!quantity.ends) for (const x of part) { if (x < low) low = x; if (x > high) high = x; }
    Plotly.restyle(place, {
      intensity: [part], cmin: low, cmax: high, colorscale: quantity.colours === "Magma" ? [MAGMA] : quantity.colours,
      showscale: true, "colorbar.title.text": quantity.unit,
    }, [0]);
  }

  choice.addEventListener("change", colour);
  level.addEventListener("input", colour);
  for (const box of section.querySelectorAll("[data-shows]")) {
    const traces = [];
    place.data.forEach((trace, index) => { if (trace.meta === box.dataset.shows) traces.push(index); });
    const show = () => { if (traces.length) Plotly.restyle(place, { visible: box.checked }, traces); };
    box.closest("label").hidden = traces.length === 0;
    box.addEventListener("change", show);
  }
  colour();
}

function choose(name) {
  for (const section of document.querySelectorAll("section.tool")) {
    section.hidden = section.dataset.tool !== name;
    if (!section.hidden) draw(section);
  }
}

const sections = document.querySelectorAll("section.tool");
const picker = document.getElementById("tool");
if (picker) picker.addEventListener("change", () => choose(picker.value));
if (sections.length) choose(sections[0].dataset.tool);

// On paper: every tool, every table, figures as wide as the sheet.
const PAPER = 690; // px
window.addEventListener("beforeprint", () => {
  for (const section of sections) { section.dataset.was = section.hidden ? "hidden" : ""; section.hidden = false; draw(section); }
  for (const more of document.querySelectorAll("details")) more.open = true;
  for (const place of document.querySelectorAll(".figure:not(.organ)")) if (place.layout) Plotly.relayout(place, { width: PAPER });
});
window.addEventListener("afterprint", () => {
  for (const section of sections) section.hidden = section.dataset.was === "hidden";
  for (const place of document.querySelectorAll(".figure:not(.organ)")) if (place.layout) Plotly.relayout(place, { width: null, autosize: true });
});
