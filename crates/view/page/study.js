// @ts-check
// The dispersion study: a beam through a prism, ray by ray as it is traced. The server does all computation.

/** @typedef {{nm: number, rgb: number[], points: number[][]}} Ray */
/** Prism, beam and light of the viewed scene. @typedef {{apex: number, side: number?, incidence: number, beam: number, glass: string?, light: string?, intensity: string, text: string?}} Start */
/** @typedef {{glasses: string[], lights: string[], start: Start?}} Choices */
/** @typedef {{nm: number[], catalogue: number[], rows: number[], two: number[], three: number[], samples: number[][], a: number, b_nm2: number, apart: number[]}} Cauchy */
/** @typedef {{outline: number[][], rays: number, nd: number, least_deviation: number[]?, deviation_deg: number?, spread_deg: number?, cauchy: Cauchy}} Shown */

/**
 * @template {Element} T
 * @param {string} id
 * @param {new (...args: any[]) => T} kind
 * @returns {T}
 */
function part(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${id}`);
  return found;
}

const state = part("state", HTMLElement);
const progress = part("progress", HTMLProgressElement);
const fault = part("fault", HTMLElement);
const figure = part("figure", SVGSVGElement);
const curves = part("curves", SVGSVGElement);
const trace = part("trace", HTMLButtonElement);
const stop = part("stop", HTMLButtonElement);
const glass = part("glass", HTMLSelectElement);
const light = part("light", HTMLSelectElement);
const intensity = part("intensity", HTMLSelectElement);
const numbers = ["apex", "side", "incidence", "beam"];
/** @param {string} name */
const slider = (name) => part(name, HTMLInputElement);
/** @param {string} name */
const field = (name) => part(`${name}-field`, HTMLInputElement);
/** @param {string} name */
const value = (name) => Number(field(name).value);

const save = part("save", HTMLButtonElement);
const saved = part("saved", HTMLElement);

/** Hash of the text of the scene's file with which the study began; empty if there is no file to save to. */
let text = "";
/** @type {Shown?} */
let shown = null;
/** @type {Ray[]} */
let rays = [];
/** Number of the current prism; work on an earlier one stops. */
let prism = 0;
let isTracing = true;

/** @param {string} path */
async function get(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}

/** @param {SVGElement} to @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
function put(to, name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  give(element, attributes);
  if (text !== undefined) element.textContent = text;
  to.append(element);
  return element;
}

// The prism ---------------------------------------------------------------------------------------------------------------------

/** Returns a point, in mm along the beam and up, as SVG coordinates. @param {number[]} at */
const place = ([z, y]) => `${z.toFixed(3)},${(-y).toFixed(3)}`;

/**
 * Returns a part of the figure, made if it is missing. Parts stay while their places change, so that a handle keeps the keyboard focus.
 * @param {string} kind @param {string} which
 */
function kept(kind, which) {
  const there = figure.querySelector(which);
  if (there instanceof SVGElement) return there;
  return put(figure, kind, {});
}

/** @param {Element} element @param {Record<string, string | number>} attributes */
function give(element, attributes) {
  for (const [key, v] of Object.entries(attributes)) element.setAttribute(key, String(v));
}

function drawPrism() {
  if (!shown) return;
  give(kept("polygon", ".prism"), { class: "prism", points: shown.outline.map(place).join(" ") });
  const group = kept("g", "#rays");
  give(group, { id: "rays" });
  group.replaceChildren();
  for (const [name, [z, y], text] of /** @type {[string, number[], string][]} */ ([
    ["apex", shown.outline[1], `apex angle ${value("apex")} degrees`],
    ["incidence", shown.outline[2], `incidence ${value("incidence")} degrees`],
    ["side", shown.outline[0], `side ${value("side")} mm`],
    ["beam", [-55, value("beam")], `height of the beam ${value("beam")} mm`],
  ])) {
    const input = field(name);
    const handle = kept("circle", `[data-moves="${name}"]`);
    give(handle, {
      class: "handle", cx: z, cy: -y, r: 2.6, tabindex: 0, role: "slider", "data-moves": name, "aria-label": text,
      "aria-valuemin": input.min, "aria-valuemax": input.max, "aria-valuenow": input.value,
    });
    const title = handle.firstElementChild ?? put(handle, "title", {});
    title.textContent = text;
  }
  drawRays(0);
}

/** Draws the traced rays from this one on. @param {number} from */
function drawRays(from) {
  const group = figure.querySelector("#rays");
  if (!(group instanceof SVGElement)) return;
  for (const ray of rays.slice(from)) {
    put(group, "polyline", { points: ray.points.map(place).join(" "), stroke: `rgb(${ray.rgb.join(" ")})` });
  }
}

/** @type {{moves: string, x: number, y: number, from: number, again?: string}?} */
let dragged = null;
figure.addEventListener("pointerdown", (event) => {
  const moves = event.target instanceof SVGElement ? event.target.dataset.moves : undefined;
  if (!moves) return;
  dragged = { moves, x: event.clientX, y: event.clientY, from: value(moves) };
  figure.setPointerCapture(event.pointerId);
  event.preventDefault();
});
figure.addEventListener("pointermove", (event) => {
  if (!dragged) return;
  const mm = 190 / figure.clientWidth;
  const [across, up] = [(event.clientX - dragged.x) * mm, (dragged.y - event.clientY) * mm];
  // Change in degrees or mm per mm of the pointer's movement.
  const by = { apex: across, incidence: across + up, side: -up - across, beam: up }[dragged.moves] ?? 0;
  set(dragged.moves, dragged.from + by);
});
for (const end of ["pointerup", "pointercancel"]) figure.addEventListener(end, () => { dragged = null; });
figure.addEventListener("keydown", (event) => {
  const moves = event.target instanceof SVGElement ? event.target.dataset.moves : undefined;
  const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
  if (!moves || !step) return;
  event.preventDefault();
  set(moves, value(moves) + step * (event.shiftKey ? 0.1 : 1));
});

/** @param {string} name @param {number} to */
function set(name, to) {
  const input = field(name);
  input.value = String(Number(Math.min(Math.max(to, Number(input.min)), Number(input.max)).toFixed(4)));
  slider(name).value = input.value;
  changed();
}

// The glass ---------------------------------------------------------------------------------------------------------------------

function drawGlass() {
  curves.replaceChildren();
  if (!shown) return;
  const { nm, catalogue, rows, two, three, samples, a, b_nm2, apart } = shown.cauchy;
  const all = [...catalogue, ...rows, ...two, ...three];
  const [least, most] = [Math.min(...all), Math.max(...all)];
  const x = (/** @type {number} */ v) => 66 + (640 * (v - nm[0])) / (nm[nm.length - 1] - nm[0]);
  const y = (/** @type {number} */ n) => 258 - (244 * (n - least)) / (most - least);
  for (let k = 0; k <= 4; k += 1) {
    const n = least + ((most - least) * k) / 4;
    put(curves, "line", { class: "grid", x1: 66, x2: 706, y1: y(n), y2: y(n) });
    put(curves, "text", { x: 60, y: y(n) + 5, "text-anchor": "end" }, n.toFixed(4));
  }
  for (let v = 400; v <= 700; v += 50) {
    put(curves, "line", { class: "grid", x1: x(v), x2: x(v), y1: 14, y2: 258 });
    put(curves, "text", { x: x(v), y: 278, "text-anchor": "middle" }, String(v));
  }
  put(curves, "text", { x: 706, y: 296, "text-anchor": "end" }, "nm");
  const line = (/** @type {number[]} */ values, /** @type {string} */ kind) =>
    put(curves, "polyline", { class: `curve ${kind}`, points: nm.map((v, i) => `${x(v).toFixed(2)},${y(values[i]).toFixed(2)}`).join(" ") });
  line(rows, "rows");
  line(two, "two");
  line(three, "three");
  line(catalogue, "catalogue");
  for (const [v, n] of samples) put(curves, "circle", { class: "sample", cx: x(v), cy: y(n), r: 4 });
  ["catalogue", "A + B/λ², means of neighboring rows", "A + B/λ², least squares", "A + B/λ² + C/λ⁴, least squares"].forEach((text, i) => {
    put(curves, "line", { class: `curve ${["catalogue", "rows", "two", "three"][i]}`, x1: 330, x2: 372, y1: 28 + 20 * i, y2: 28 + 20 * i });
    put(curves, "text", { x: 380, y: 33 + 20 * i }, text);
  });
  part("fits", HTMLElement).textContent =
    `By rows: A = ${a.toFixed(5)}, B = ${b_nm2.toFixed(0)} nm². Largest deviation from the catalogue at the six lines: ` +
    `${apart.map((v) => v.toExponential(1)).join(", ")} (rows, two terms, three terms).`;
}

// Work --------------------------------------------------------------------------------------------------------------------------

function asked() {
  const words = new URLSearchParams(numbers.map((name) => [name, field(name).value]));
  words.set("glass", String(glass.selectedIndex));
  words.set("light", String(light.selectedIndex));
  words.set("intensity", intensity.value);
  return words;
}

/** Draws the changed prism, and traces its rays unless tracing was stopped. */
async function changed() {
  prism += 1;
  const mine = prism;
  const words = asked();
  try {
    const next = await get(`/prism?${words}`);
    if (mine !== prism) return;
    shown = next;
    rays = [];
    fault.hidden = true;
    drawPrism();
    drawGlass();
    tell();
    if (isTracing) await grow(mine, words);
  } catch (error) {
    if (mine !== prism) return;
    fault.textContent = error instanceof Error ? error.message : String(error);
    fault.hidden = false;
  }
}

/** Traces further rays until all are there or the prism changes. @param {number} mine @param {URLSearchParams} words */
async function grow(mine, words) {
  while (isTracing && mine === prism && shown && rays.length < shown.rays) {
    const first = rays.length;
    const { rays: more } = await get(`/rays?${words}&first=${first}&count=24`);
    if (mine !== prism || !isTracing) break;
    rays.push(...more);
    drawRays(first);
    tell();
    await new Promise((drawn) => requestAnimationFrame(drawn));
  }
  tell();
}

function tell() {
  if (!shown) return;
  const isWhole = rays.length >= shown.rays;
  state.textContent = `${isWhole ? "traced" : isTracing ? "tracing" : "stopped"}: ${rays.length} of ${shown.rays} rays`;
  progress.value = shown.rays > 0 ? rays.length / shown.rays : 1;
  stop.disabled = !isTracing || isWhole;
  trace.disabled = isTracing && !isWhole;
  const least = shown.least_deviation;
  const bent = shown.deviation_deg === null ? "The beam does not leave through the second face" : `The beam is bent by ${shown.deviation_deg.toFixed(3)}° (d line)`;
  const spread = shown.spread_deg === null ? "" : `; 400 and 700 nm leave ${shown.spread_deg.toFixed(3)}° apart`;
  const at = least ? `; least deviation ${least[1].toFixed(3)}° at ${least[0].toFixed(3)}° of incidence` : "; no beam passes this prism symmetrically";
  part("said", HTMLElement).textContent = `${bent}${spread}; n = ${shown.nd.toFixed(5)}${at}.`;
}

trace.addEventListener("click", () => {
  isTracing = true;
  if (shown && rays.length >= shown.rays) changed();
  else grow(prism, asked());
});
stop.addEventListener("click", () => {
  isTracing = false;
  tell();
});
part("least", HTMLButtonElement).addEventListener("click", () => {
  if (shown?.least_deviation) set("incidence", shown.least_deviation[0]);
});
for (const name of numbers) {
  slider(name).addEventListener("input", () => {
    field(name).value = slider(name).value;
    changed();
  });
  field(name).addEventListener("input", () => {
    if (field(name).value === "") return;
    slider(name).value = field(name).value;
    changed();
  });
}
for (const list of [glass, light, intensity]) list.addEventListener("change", () => changed());
part("controls", HTMLFormElement).addEventListener("submit", (event) => event.preventDefault());

/** Starts with the values of the scene; values that the study does not know stay as they are. @param {Start} start */
function begin(start) {
  for (const name of numbers) {
    const known = start[/** @type {"apex"} */ (name)];
    if (known === null) continue;
    field(name).value = String(Number(known.toFixed(4)));
    slider(name).value = field(name).value;
  }
  for (const [list, known] of /** @type {[HTMLSelectElement, string?][]} */ ([[glass, start.glass], [light, start.light], [intensity, start.intensity]])) {
    if ([...list.options].some((option) => option.value === known)) list.value = String(known);
  }
  text = start.text ?? "";
  save.disabled = text === "";
}

save.addEventListener("click", async () => {
  const words = asked();
  words.set("text", text);
  const answer = await fetch(`/keep?${words}`, { method: "POST" });
  if (!answer.ok) {
    saved.textContent = (await answer.text()).trim();
    return;
  }
  const said = await answer.json();
  text = said.text;
  saved.textContent = `The prism was written to ${said.lens}, and ${said.saved === 1 ? "1 value" : `${said.saved} values`} to the scene.`;
});

try {
  /** @type {Choices} */
  const choices = await get("/choices");
  glass.append(...choices.glasses.map((name) => new Option(name, name, false, name === "SCHOTT/N-SF11")));
  light.append(...choices.lights.map((name) => new Option(name.replace("blackbody:5800", "5 800 K"), name)));
  if (choices.start) begin(choices.start);
  await changed();
} catch (error) {
  state.textContent = "stopped";
  fault.textContent = `${error instanceof Error ? error.message : error}: reload the page, or start \`spectra view\` again`;
  fault.hidden = false;
}
