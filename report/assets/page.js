"use strict";
(() => {
  const page = document.documentElement;
  // Looks that all plots share; the data and the axes come with each figure.
  const axis = {
    automargin: true, showline: true, linecolor: "#1d2329", linewidth: 1, mirror: "all",
    ticks: "inside", ticklen: 5, tickcolor: "#1d2329", gridcolor: "#e3e7ea",
    zeroline: true, zerolinecolor: "#b9c1c7", zerolinewidth: 1,
    exponentformat: "power", hoverformat: ".6~g", title: { standoff: 8 },
    minor: { gridcolor: "#f1f3f5" },
  };
  const looks = {
    font: {
      family: getComputedStyle(document.body).fontFamily, size: 13, color: "#1d2329",
    },
    paper_bgcolor: "#ffffff", plot_bgcolor: "#ffffff", autosize: true,
    margin: { l: 60, r: 14, t: 26, b: 44 }, bargap: 0, hoversubplots: "axis", dragmode: "zoom",
    legend: {
      orientation: "h", x: 0, xanchor: "left", y: 1, yanchor: "bottom",
      bgcolor: "rgba(0,0,0,0)",
      itemsizing: "trace", tracegroupgap: 0,
    },
    modebar: { bgcolor: "rgba(0,0,0,0)" },
    hoverlabel: { font: { size: 12 }, namelength: -1 },
    xaxis: axis, yaxis: axis,
    annotationdefaults: { arrowwidth: 1, arrowsize: 0.9, arrowcolor: "#555555", font: { size: 12 } },
    shapedefaults: { label: { font: { size: 12, color: "#444444" } } },
  };
  const hoverText = (trace, closest) => {
    const unit = trace.meta ? " %{meta}" : "";
    if (trace.type === "heatmap") return `%{x:.6~g}, %{y:.6~g}: %{z:.6~g}${unit}<extra></extra>`;
    if (trace.orientation === "h") return "%{y}: %{x:.6~g}<extra></extra>";
    return `${closest ? "%{x:.6~g}, " : ""}%{y:.6~g}${unit}`;
  };
  // The buttons are named one by one: the library's own choice has one that uploads the data.
  const config = {
    responsive: true, displaylogo: false, displayModeBar: "hover", showSendToCloud: false,
    modeBarButtons: [["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"], ["toImage"]],
  };

  const drawings = [];
  const draw = async ({ canvas, view, name }) => {
    const closest = view.layout.hovermode === "closest";
    for (const trace of view.data) trace.hovertemplate = hoverText(trace, closest);
    view.layout.template = { layout: looks };
    await Plotly.newPlot(canvas, view.data, view.layout, {
      ...config, toImageButtonOptions: { filename: name, scale: 2 },
    });
    drawings.push(canvas);
  };

  const jobs = [];
  for (const figure of document.querySelectorAll("figure")) {
    const views = JSON.parse(figure.querySelector("script").textContent);
    const canvases = [...figure.querySelectorAll(".canvas")];
    views.forEach((view, k) =>
      jobs.push({ canvas: canvases[k], view, name: figure.id, zooms: k ? [] : canvases.slice(1) }));
  }
  page.dataset.plots = jobs.length;

  const drawAll = async () => {
    for (const job of jobs) {
      try {
        await draw(job);
        // The legend of the whole view switches its zooms as well.
        job.canvas.on("plotly_restyle", () => {
          const visible = job.canvas.data.map((trace) => trace.visible ?? true);
          job.zooms.forEach((zoom) => Plotly.restyle(zoom, { visible }));
        });
      } catch (error) {
        job.canvas.classList.add("failed");
        job.canvas.textContent = `This plot could not be drawn: ${error.message}`;
        page.complain(error.message);
      }
      page.dataset.plotsDrawn = drawings.length;
      // Let the reader scroll in between.
      await new Promise((next) => setTimeout(next, 0));
    }
    page.dataset.requests = performance.getEntriesByType("resource").length;
    page.dataset.ready = page.dataset.pageErrors ? "with errors" : "yes";
  };

  // Paper is narrower than a screen: draw for its width, and put the screen back afterwards.
  const PAPER_WIDTH_PX = 680;
  addEventListener("beforeprint", () =>
    drawings.forEach((canvas) => Plotly.relayout(canvas, { width: PAPER_WIDTH_PX })));
  addEventListener("afterprint", () =>
    drawings.forEach((canvas) => Plotly.relayout(canvas, { width: null, autosize: true })));

  const rows = (table) =>
    [...table.rows].map((row) =>
      [...row.cells].map((cell) =>
        cell.classList.contains("empty") ? "" : cell.textContent.replace(/\s+/g, " ").trim()));
  const asTabs = (table) => rows(table).map((row) => row.join("\t")).join("\n") + "\n";
  const asMarkdown = (table) => {
    const lines = rows(table).map((row) =>
      `| ${row.map((text) => text.replaceAll("|", "\\|")).join(" | ")} |`);
    const rule = [...table.rows[0].cells].map((cell) =>
      cell.classList.contains("n") ? "---:" : "---");
    lines.splice(1, 0, `| ${rule.join(" | ")} |`);
    return lines.join("\n") + "\n";
  };
  const copy = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Some browsers keep the clipboard from pages opened as files.
      const area = document.createElement("textarea");
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
  };
  for (const table of document.querySelectorAll("table")) {
    const buttons = document.createElement("span");
    buttons.className = "copy";
    for (const [label, format] of [["copy", asTabs], ["copy as Markdown", asMarkdown]]) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = label;
      button.addEventListener("click", async () => {
        await copy(format(table));
        button.textContent = "copied";
        setTimeout(() => { button.textContent = label; }, 1200);
      });
      buttons.append(button);
    }
    table.caption.append(buttons);
  }

  drawAll();
})();
