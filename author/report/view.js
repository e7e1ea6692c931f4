// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Draws a tool's figures when its section is first shown, and recolours the organ as its controls say.
"use strict";

const CONFIG = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d"] };
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

  function colour() {
    const d = Number(level.value);
    shown.textContent = maps.depths[d] + " mm";
    const index = maps.quantities.findIndex((quantity) => quantity.key === choice.value);
    level.disabled = index < 0;
    if (index < 0) {
      Plotly.restyle(place, { colorscale: [PLAIN], showscale: false }, [0]);
      return;
    }
    const count = values[index].length / maps.depths.length;
    const part = values[index].slice(d * count, (d + 1) * count);
    let low = Infinity, high = -Infinity;
    for (const x of part) { if (x < low) low = x; if (x > high) high = x; }
    Plotly.restyle(place, {
      intensity: [part], cmin: low, cmax: high, colorscale: "Viridis", showscale: true,
      "colorbar.title.text": maps.quantities[index].unit,
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
