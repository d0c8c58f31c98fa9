"use strict";

// The page of a run. Everything that is shown comes as an event: `facts` once, `now` ten times a
// second. Text is set as text, never as markup.

const LOOP_MS = 3000;
const TRACE_MS = 10000;
/** Model time without a row that is drawn as a gap. */
const GAP_MS = 500;
/** Real time without a word of the program after which the page says that it is old. */
const SILENCE_MS = 3000;
const COLOURS = 8;
/**
 * Columns of a row for every slot: what its rig was told and measured (µm, µm, N; null without a
 * rig), the extension (µm), and the force that acts (N).
 */
const COLUMNS = 5;
/** Labels of an axis, at least. */
const LABELS = 3;

const root = document.documentElement;
const at = (id) => document.getElementById(id);
const token = document.querySelector("meta[name=ramp-out-token]").content;
const style = getComputedStyle(root);
const variable = (name) => style.getPropertyValue(name).trim();
const colour = (slot) => variable(`--slot-${slot % COLOURS}`);

let facts = null;
let now = null;
let rows = [];
let heard = performance.now();
let hasEnded = false;
let isDue = false;

root.dataset.errors = "0";
const failed = () => { root.dataset.errors = String(Number(root.dataset.errors) + 1); };
addEventListener("error", failed);
addEventListener("unhandledrejection", failed);

// Text

function show(id, text) {
  const element = at(id);
  if (element.textContent !== text) element.textContent = text;
  if (element.hasAttribute("hidden") !== (text === "")) element.toggleAttribute("hidden", text === "");
}

function element(name, text, parent) {
  const made = document.createElement(name);
  made.textContent = text;
  parent.append(made);
  return made;
}

/** Four significant digits, without an exponent where people write none. */
function number(value) {
  if (value === null || value === undefined) return "–";
  const rounded = Number(value.toPrecision(4));
  const isPlain = rounded === 0 || (Math.abs(rounded) >= 1e-4 && Math.abs(rounded) < 1e7);
  return isPlain ? String(rounded) : rounded.toExponential();
}

/** Fills a table; cells are texts, or numbers for a meter. `marks` are the classes of the rows. */
function fill(id, lines, numeric, marks = []) {
  const body = at(id);
  while (body.rows.length > lines.length) body.deleteRow(-1);
  lines.forEach((cells, index) => {
    const row = body.rows[index] ?? body.insertRow();
    row.className = marks[index] ?? "";
    cells.forEach((cell, column) => {
      const known = row.cells[column];
      const place = known ?? row.insertCell();
      if (!known && numeric.includes(column)) place.className = "n";
      if (typeof cell === "number") {
        const meter = place.firstElementChild ?? element("meter", "", place);
        // Beyond four fifths of a limit it turns amber, and beyond the limit red.
        [meter.low, meter.high, meter.optimum, meter.value] = [0.8, 0.999, 0, cell];
      } else if (place.textContent !== cell) {
        place.textContent = cell;
      }
    });
  });
}

// Plots

/** Multiples of 1, 2 or 5 that divide a range into about so many parts, and give enough labels. */
function ticks(low, high, parts) {
  const raw = (high - low) / parts;
  const power = 10 ** Math.floor(Math.log10(raw));
  const steps = [10, 5, 2, 1, 0.5, 0.2, 0.1].map((factor) => factor * power);
  let found = [];
  for (const step of steps.slice(steps.findLastIndex((size) => size >= raw))) {
    found = [];
    for (let k = Math.ceil(low / step); k * step <= high; k += 1) found.push(Number((k * step).toPrecision(12)));
    if (found.length >= LABELS) break;
  }
  return found;
}

/** A range around values, never empty. */
function range(values, least) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value !== null && value < low) low = value;
    if (value !== null && value > high) high = value;
  }
  if (low > high) [low, high] = [-least, least];
  const margin = Math.max(0.05 * (high - low), 0.5 * (least - (high - low)), 0);
  return [low - margin, high + margin];
}

/**
 * An empty plot: its context, and where values go. The units stand in two corners. On `isLog` axes
 * values are powers of ten.
 */
function axes(canvas, [left, right], [bottom, top], [across, up], isLog = false) {
  const scale = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [inWidth, inHeight] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== inWidth || canvas.height !== inHeight) [canvas.width, canvas.height] = [inWidth, inHeight];
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  const [x0, x1, y0, y1] = [46, width - 8, height - 22, 8];
  const x = (value) => x0 + ((value - left) / (right - left)) * (x1 - x0);
  const y = (value) => y0 + ((value - bottom) / (top - bottom)) * (y1 - y0);
  pen.font = "11px system-ui, sans-serif";
  pen.fillStyle = variable("--quiet");
  pen.strokeStyle = variable("--line");
  pen.lineWidth = 1;
  pen.beginPath();
  const shown = (low, high, parts) => ticks(low, high, parts).filter((value) => !isLog || Number.isInteger(value));
  const words = (value) => number(isLog ? 10 ** value : value);
  const [along, upward] = [shown(left, right, Math.max(LABELS, width / 90)), shown(bottom, top, 5)];
  pen.textAlign = "center";
  for (const value of along) {
    pen.moveTo(x(value), y0);
    pen.lineTo(x(value), y1);
    // The last one would not fit on the plot below its line.
    const half = pen.measureText(words(value)).width / 2;
    pen.fillText(words(value), Math.min(x(value), width - 2 - half), height - 7);
  }
  pen.textAlign = "right";
  for (const value of upward) {
    pen.moveTo(x0, y(value));
    pen.lineTo(x1, y(value));
    pen.fillText(words(value), x0 - 5, y(value) + 4);
  }
  pen.stroke();
  pen.fillText(across, x1 - 4, y0 - 5);
  pen.textAlign = "left";
  pen.fillText(up, x0 + 4, y1 + 10);
  canvas.dataset.across = `${along.map(words).join(" ")} ${across}`;
  canvas.dataset.up = `${upward.map(words).join(" ")} ${up}`;
  return { pen, x, y };
}

/** A line through points [x, y], interrupted where `isGap` says so or a value is missing. */
function line({ pen, x, y }, points, stroke, width, isGap = () => false) {
  pen.strokeStyle = stroke;
  pen.lineWidth = width;
  pen.lineJoin = "round";
  pen.beginPath();
  let before = null;
  for (const point of points) {
    if (point[0] === null || point[1] === null) {
      before = null;
      continue;
    }
    if (before === null || isGap(before, point)) pen.moveTo(x(point[0]), y(point[1]));
    else pen.lineTo(x(point[0]), y(point[1]));
    before = point;
  }
  pen.stroke();
}

const scaled = (value, factor) => (value === null ? null : value * factor);
const column = (offset) => (row, slot) => scaled(row[offset + COLUMNS * slot], 1e-3);
const [commanded, measured, measuredForce, extension, force] = [1, 2, 3, 4, 5].map(column);
const isRig = (slot) => facts.slots[slot].is === "rig";

/** All loops on one scale, so that they can be compared. */
function drawLoops() {
  const recent = rows.filter((row) => row[0] > rows[rows.length - 1][0] - LOOP_MS);
  const loops = facts.slots.map((_, slot) => recent.map((row) => [extension(row, slot), force(row, slot)]));
  const all = loops.flat();
  const [across, up] = [0, 1].map((axis) => range(all.map((point) => point[axis]), 0.2));
  loops.forEach((points, slot) => {
    line(axes(at(`loop-${slot}`), across, up, ["mm", "kN"]), points, colour(slot), 1.6);
  });
}

function drawTraces() {
  const end = rows[rows.length - 1][0] * 1e-3;
  const span = [end - TRACE_MS * 1e-3, end];
  const isGap = (a, b) => (b[0] - a[0]) * 1e3 > Math.max(GAP_MS, 3 * step());
  const trace = (of, slot) => rows.map((row) => [row[0] * 1e-3, of(row, slot)]);
  const values = (lines) => lines.flatMap((points) => points.map((point) => point[1]));
  drawnSlots().forEach((slot) => {
    const [asked, seen] = [trace(commanded, slot), trace(isRig(slot) ? measured : extension, slot)];
    const plot = axes(at(`displacement-${slot}`), span, range(values([asked, seen]), 0.2), ["s", "mm"]);
    line(plot, asked, "#b4bcc3", 5, isGap);
    line(plot, seen, colour(slot), 1.5, isGap);
  });
  const forces = facts.slots.map((_, slot) => trace(isRig(slot) ? measuredForce : force, slot));
  const plot = axes(at("forces"), span, range(values(forces), 0.2), ["s", "kN"]);
  forces.forEach((points, slot) => line(plot, points, colour(slot), 1.5, isGap));
}

/** Time between the last two rows (ms). */
function step() {
  return rows.length < 2 ? 0 : rows[rows.length - 1][0] - rows[rows.length - 2][0];
}

function drawHistogram(counts) {
  const edges = facts.edges_us;
  const log = Math.log10;
  const most = Math.max(1, ...counts);
  const last = log(edges[edges.length - 1]) + 0.125;
  const plot = axes(at("histogram"), [log(edges[0]), last], [0, log(most) + 0.3], ["µs", "cycles"], true);
  const { pen, x, y } = plot;
  pen.fillStyle = colour(0);
  counts.forEach((count, bin) => {
    if (count === 0) return;
    const right = bin + 1 < edges.length ? log(edges[bin + 1]) : last;
    // One cycle is to be seen too.
    const top = y(log(count) + 0.15);
    pen.fillRect(x(log(edges[bin])), top, x(right) - x(log(edges[bin])) - 1, y(0) - top);
  });
}

/** Slots whose displacement is drawn: the rigs, or all where there is none. */
function drawnSlots() {
  const all = facts.slots.map((_, slot) => slot);
  const rigs = all.filter(isRig);
  return rigs.length > 0 ? rigs : all;
}

function draw() {
  isDue = false;
  if (!facts || !now?.update) return;
  if (rows.length > 0) {
    drawLoops();
    drawTraces();
    root.dataset.drawn = String(Number(root.dataset.drawn ?? 0) + 1);
  }
  drawHistogram(now.update.timing.histogram);
}

// Events

function figure(parent, caption, id, keys = []) {
  const made = element("figure", "", parent);
  const words = element("figcaption", caption, made);
  for (const [name, stroke] of keys) {
    element("span", "", words).className = "key";
    words.lastElementChild.style.borderColor = stroke;
    words.append(name);
  }
  const canvas = element("canvas", "", made);
  canvas.id = id;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", caption);
}

/** Where the force of a slot comes from. */
function source(slot) {
  const is = slot.is.replaceAll("_", " ");
  const sign = slot.is_reversed ? ", its sign reversed" : "";
  return slot.of === null ? is : `${is}: the rig of ${slot.of} stands in for it${sign}`;
}

function showWarnings(warnings) {
  const list = at("warnings");
  list.replaceChildren();
  warnings.forEach((warning) => element("li", warning, list));
  list.toggleAttribute("hidden", warnings.length === 0);
}

function takeFacts(event) {
  if (facts) return;
  facts = JSON.parse(event.data);
  document.title = `${facts.title} – yawbench`;
  show("title", facts.title);
  const pace = facts.is_clocked ? "real time" : `pace ${facts.pace}`;
  show("about", `${facts.vehicle} at ${number(facts.speed_kmh)} km/h for ${number(facts.duration_s)} s, bus ${facts.bus}, ${pace}`);
  facts.slots.forEach((slot, index) => figure(at("loops"), `${slot.place} (${source(slot)})`, `loop-${index}`));
  showWarnings(facts.warnings);
  for (const slot of drawnSlots()) {
    const keys = isRig(slot) ? [["command", "#b4bcc3"], ["measured", colour(slot)]] : [];
    const what = isRig(slot) ? "Displacement of the rig" : "Extension";
    figure(at("traces"), `${what} of ${facts.slots[slot].place}, mm`, `displacement-${slot}`, keys);
  }
  figure(at("traces"), "Force, kN", "forces", facts.slots.map((slot, index) => [slot.place, colour(index)]));
}

function takeNow(event) {
  now = JSON.parse(event.data);
  heard = performance.now();
  root.classList.remove("is-old");
  showState(now.state);
  show("note", now.end ? "" : now.note);
  if (now.update) takeUpdate(now.update);
  if (now.end) takeEnd(now.end);
  if (!isDue) {
    isDue = true;
    requestAnimationFrame(draw);
  }
}

function showState(state) {
  const kinds = { RUN: "run", ARMED: "moving", RAMP_IN: "moving", RAMP_OUT: "moving", SAFE: "bad", FAULT: "bad" };
  const ended = now.end ? "ended" : state;
  show("state", ended);
  at("state").className = `state ${now.end ? (now.end.is_good ? "run" : "bad") : kinds[state] ?? ""}`;
  root.dataset.state = ended;
}

function takeUpdate(update) {
  const last = rows.length > 0 ? rows[rows.length - 1][0] : -Infinity;
  rows.push(...update.samples.filter((row) => row[0] > last));
  const newest = rows.length > 0 ? rows[rows.length - 1][0] : 0;
  rows = rows.filter((row) => row[0] > newest - TRACE_MS);
  root.dataset.time = String(newest);
  show("time", `${update.time_s.toFixed(1)} s, ${update.distance_m.toFixed(0)} m`);
  show("cause", update.cause && !now.end ? `What ends the run: ${update.cause}` : "");
  if (!facts) return;
  const place = (slot) => facts.slots[slot]?.place ?? "";
  fill("interlocks", update.interlocks.map((lock) => [
    place(lock.slot), lock.check.replaceAll("_", " "),
    lock.margin_percent === null ? "–" : (100 - lock.margin_percent).toFixed(0),
    lock.margin_percent === null ? "" : Math.min(1, Math.max(0, 1 - lock.margin_percent / 100)),
    lock.action ?? "–", number(lock.largest), number(lock.limit), lock.unit ?? "",
  ]), [2, 5, 6], update.interlocks.map((lock) => {
    if (lock.has_tripped) return "tripped";
    return lock.margin_percent !== null && lock.margin_percent < 20 ? "small" : "";
  }));
  fill("rigs", update.rigs.map((rig) => [
    place(rig.slot), rig.state ?? "–", rig.age_cycles === null ? "–" : String(rig.age_cycles), String(rig.fresh),
    String(rig.lost), (100 * rig.coupling).toFixed(0), number(rig.temperature_degc), rig.watch ?? "–",
  ]), [2, 3, 4, 5, 6]);
  const { timing } = update;
  const times = (name, of) => [name, ...["p50", "p99", "p99_9", "max"].map((key) => of[key].toFixed(1))];
  const lines = timing.cycle_us ? [times("receive to send", timing.cycle_us)] : [];
  if (facts.is_clocked && timing.lateness_us) lines.push(times("wake-up late by", timing.lateness_us));
  fill("times", lines, [1, 2, 3, 4]);
  show("clock", facts.is_clocked
    ? `${timing.skipped} ticks skipped, ${timing.late} wake-ups more than 0.1 ms late, of ${update.cycle} cycles.`
    : `No clock sets deadlines at this pace. ${update.cycle} cycles.`);
}

function takeEnd(end) {
  show("end-words", end.words);
  show("end-why", end.why ?? "");
  show("end-files", end.files ?? "");
  at("end").className = `note ${end.is_good ? "good" : "bad"}`;
  at("end").hidden = false;
  // While the files are being written nothing else is known.
  if (end.warnings.length > 0) showWarnings(end.warnings);
  hasEnded = true;
}

const events = new EventSource("events");
events.addEventListener("facts", takeFacts);
events.addEventListener("now", takeNow);
events.addEventListener("error", () => {
  // Behind the end nobody answers any more.
  if (hasEnded) events.close();
});

setInterval(() => {
  const silent = performance.now() - heard;
  if (hasEnded || silent < SILENCE_MS) return;
  root.classList.add("is-old");
  at("state").className = "state old";
  show("state", "no connection");
  show("note", `Nothing was heard of the program for ${(silent * 1e-3).toFixed(0)} s: it may have ended. What is shown is old.`);
  root.dataset.state = "no connection";
}, 500);

addEventListener("resize", () => requestAnimationFrame(draw));

at("ramp-out").addEventListener("click", async () => {
  show("asked", "Asking for the ramp-out …");
  try {
    const answer = await fetch("ramp-out", { method: "POST", headers: { "X-Yawbench-Token": token } });
    show("asked", answer.ok ? "Ramp-out asked for." : `Not taken: ${await answer.text()}`);
  } catch {
    show("asked", hasEnded ? "The run has ended." : "Not taken: no connection. Key s or Ctrl-C in the terminal ends the run.");
  }
});
