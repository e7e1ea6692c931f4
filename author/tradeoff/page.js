// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The legend and two boxes filter figure and table alike; headings sort; a clicked mark shows its row.
"use strict";
const figure = JSON.parse(document.getElementById("data").textContent);
const plot = document.getElementById("figure");
const body = document.querySelector("#rows tbody");
const all = [...body.rows];
const boxes = { front: document.getElementById("only-front"), met: document.getElementById("only-met") };

function filter() {
  const hidden = new Set(plot.data.filter((t) => t.visible === "legendonly").map((t) => t.name));
  let shown = 0;
  for (const row of all) {
    const off = hidden.has(row.dataset.family)
      || (boxes.front.checked && row.dataset.front !== "1") || (boxes.met.checked && row.dataset.met !== "1");
    row.hidden = off;
    shown += off ? 0 : 1;
  }
  document.getElementById("count").textContent = `${shown} of ${all.length} rows`;
}

function fade() {
  const dim = (i) => (boxes.front.checked && all[i].dataset.front !== "1") || (boxes.met.checked && all[i].dataset.met !== "1");
  const traces = [], opacity = [];
  plot.data.forEach((trace, k) => {
    if (!trace.customdata) return;
    traces.push(k);
    opacity.push([...trace.customdata].map((i) => (dim(i) ? 0.08 : 0.9)));
  });
  if (traces.length) Plotly.restyle(plot, { "marker.opacity": opacity }, traces);
}

function choose(row) {
  all.forEach((other) => other.classList.toggle("chosen", other === row));
  row.scrollIntoView({ block: "nearest" });
}

Plotly.newPlot(plot, figure.data, figure.layout, { responsive: true, displaylogo: false }).then(() => {
  plot.on("plotly_click", (event) => {
    const index = event.points[0].customdata;
    if (index !== undefined) choose(all[index]);
  });
  plot.on("plotly_restyle", filter);
  filter();
});
for (const box of Object.values(boxes)) box.addEventListener("change", () => { fade(); filter(); });
for (const heading of document.querySelectorAll("th[data-sort]")) {
  let down = false;
  heading.addEventListener("click", () => {
    const column = Number(heading.dataset.sort);
    const value = (row) => (column < 0 ? Number(row.dataset.row) : row.cells[column + 1].dataset.value);
    const order = (a, b) => (isNaN(a) || isNaN(b) ? String(a).localeCompare(String(b)) : a - b);
    const sorted = [...all].sort((a, b) => order(value(a), value(b)) * (down ? -1 : 1));
    sorted.forEach((row) => body.append(row));
    down = !down;
  });
}
