// @ts-check
// The color tester: light of one wavelength or a narrow band, as a screen can show it. The server computes all figures.

/** @typedef {{nm: number, x: number, y: number, srgb: number[]}} Spectral */
/** @typedef {{name: string, title: string, corners: number[][], white: number[]}} Space */
/** @typedef {{locus: Spectral[], spaces: Space[], range_nm: number[], widest_nm: number}} Diagram */
/**
 * @typedef {{nm: number, xy: number[]?, efficacy: number, linear: number[], signed: number[], coded: number[], coded_exact: number[],
 *   outside: {channel: string, by: number}[], shown_xy: number[]?, shown_apart: number?, mixed_xy: number[]?, mixed_coded: number[],
 *   mixed_exact: number[], mixed_apart: number?}} Color
 */

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
const fault = part("fault", HTMLElement);
const diagram = part("diagram", SVGSVGElement);
const space = part("space", HTMLSelectElement);
const gamut = part("gamut", HTMLSelectElement);
const numbers = ["nm", "intensity", "width", "r", "g", "b"];
/** @param {string} name */
const slider = (name) => part(name, HTMLInputElement);
/** @param {string} name */
const field = (name) => part(`${name}-field`, HTMLInputElement);

/** @type {Diagram} */
let drawn;
/** @type {Color} */
let color;
let isAsking = false;
let isChanged = false;

/** @param {string} path */
async function get(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}

// The diagram -------------------------------------------------------------------------------------------------------------------

const SIDE = 600, LEFT = 56, BOTTOM = 44;
/** @param {number} x @param {number} y */
const place = (x, y) => [LEFT + (x / 0.8) * (SIDE - LEFT - 16), SIDE - BOTTOM - (y / 0.9) * (SIDE - BOTTOM - 12)];

/** @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
function shape(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}

/** @typedef {{x: number, y: number, width: number, height: number}} Box */
/** @param {Box} a @param {Box} b */
const meet = (a, b) => a.x < b.x + b.width + 2 && b.x < a.x + a.width + 2 && a.y < b.y + b.height + 1 && b.y < a.y + a.height + 1;

/**
 * Puts a label at the first free place around a point, off the lines if possible. If all places are taken, an optional label is left out.
 * @param {Box[]} taken @param {Box[]} lines @param {number[]} at @param {string} text @param {string} kind @param {boolean} mustBe
 */
function label(taken, lines, at, text, kind, mustBe) {
  const element = shape("text", { class: `label ${kind}`, x: 0, y: 0 }, text);
  diagram.append(element);
  if (!(element instanceof SVGGraphicsElement)) return;
  const size = element.getBBox();
  /** @type {Box?} */
  let found = null;
  const fars = mustBe ? [9, 22, 36, 52, 70, 90] : [9];
  for (const [far, others] of /** @type {[number, Box[]][]} */ ([...fars.map((far) => [far, [...taken, ...lines]]), ...fars.map((far) => [far, taken])])) {
    for (let i = 0; i < 16 && !found; i += 1) {
      const angle = (i * Math.PI) / 8;
      const [cx, cy] = [at[0] + (far + size.width / 2) * Math.cos(angle), at[1] - (far + size.height / 2) * Math.sin(angle)];
      const box = { x: cx - size.width / 2, y: cy - size.height / 2, width: size.width, height: size.height };
      const isInside = box.x >= 2 && box.y >= 2 && box.x + box.width <= 638 && box.y + box.height <= SIDE - BOTTOM - 2;
      if (isInside && !others.some((other) => meet(box, other))) found = box;
    }
    if (found) break;
  }
  if (!found) {
    element.remove();
    return;
  }
  taken.push(found);
  element.setAttribute("x", String(found.x));
  element.setAttribute("y", String(found.y - size.y));
}

function draw() {
  diagram.replaceChildren();
  const points = drawn.locus.map((s) => place(s.x, s.y).map((v) => v.toFixed(2)).join(","));
  for (let i = 0; i <= 8; i += 1) {
    const [x, y] = place(i / 10, 0);
    diagram.append(shape("line", { class: "grid", x1: x, y1: y, x2: x, y2: place(0, 0.9)[1] }));
    diagram.append(shape("text", { class: "axis", x, y: y + 18, "text-anchor": "middle" }, (i / 10).toFixed(1)));
  }
  for (let i = 0; i <= 9; i += 1) {
    const [x, y] = place(0, i / 10);
    diagram.append(shape("line", { class: "grid", x1: x, y1: y, x2: place(0.8, 0)[0], y2: y }));
    // One zero is enough for both axes.
    if (i > 0) diagram.append(shape("text", { class: "axis", x: x - 8, y: y + 5, "text-anchor": "end" }, (i / 10).toFixed(1)));
  }
  diagram.append(shape("text", { class: "axis", x: place(0.8, 0)[0], y: place(0, 0)[1] + 36, "text-anchor": "end" }, "x"));
  diagram.append(shape("text", { class: "axis", x: 12, y: place(0, 0.86)[1] }, "y"));
  diagram.append(shape("polygon", { class: "locus", points: points.join(" ") }));
  for (let i = 1; i < drawn.locus.length; i += 1) {
    const [a, b] = [drawn.locus[i - 1], drawn.locus[i]];
    const [p, q] = [place(a.x, a.y), place(b.x, b.y)];
    diagram.append(shape("line", { x1: p[0], y1: p[1], x2: q[0], y2: q[1], "stroke-width": 4, stroke: `rgb(${b.srgb.join(" ")})` }));
  }
  const chosen = drawn.spaces.find((s) => s.name === space.value) ?? drawn.spaces[0];
  diagram.append(shape("polygon", { class: "gamut", points: chosen.corners.map(([x, y]) => place(x, y).join(",")).join(" ") }));
  const white = place(chosen.white[0], chosen.white[1]);
  diagram.append(shape("circle", { class: "white", cx: white[0], cy: white[1], r: 3 }));
  /** @type {Box[]} */
  const taken = [...diagram.querySelectorAll("text")].map((text) => text.getBBox());
  // Places along the lines that a label would cover.
  /** @type {Box[]} */
  const lines = [];
  const along = (/** @type {number[]} */ [ax, ay], /** @type {number[]} */ [bx, by]) => {
    const steps = Math.max(1, Math.ceil(Math.hypot(bx - ax, by - ay) / 6));
    for (let i = 0; i <= steps; i += 1) lines.push({ x: ax + ((bx - ax) * i) / steps - 1, y: ay + ((by - ay) * i) / steps - 1, width: 2, height: 2 });
  };
  drawn.locus.slice(1).forEach((s, i) => along(place(drawn.locus[i].x, drawn.locus[i].y), place(s.x, s.y)));
  chosen.corners.forEach(([x, y], i) => {
    const [u, v] = chosen.corners[(i + 1) % chosen.corners.length];
    along(place(x, y), place(u, v));
  });
  const mark = (/** @type {number[]?} */ xy, /** @type {string} */ kind) => {
    if (!xy) return null;
    const at = place(xy[0], xy[1]);
    diagram.append(shape("circle", { class: `mark ${kind}`, cx: at[0], cy: at[1], r: 7 }));
    taken.push({ x: at[0] - 8, y: at[1] - 8, width: 16, height: 16 });
    return at;
  };
  const light = mark(color.xy, "light");
  const shown = color.shown_apart !== null && color.shown_apart > 5e-4 ? mark(color.shown_xy, "shown") : null;
  const mixed = mark(color.mixed_xy, "mixed");
  if (light) label(taken, lines, light, `${color.nm} nm`, "light", true);
  if (shown) label(taken, lines, shown, "as shown", "shown", true);
  if (mixed) label(taken, lines, mixed, "your mixture", "mixed", true);
  for (const nm of [460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 620, 700]) {
    const at = drawn.locus.find((s) => s.nm === nm);
    if (at) label(taken, lines, place(at.x, at.y), String(nm), "spectral", false);
  }
  label(taken, lines, white, "white", "spectral", false);
}

// The figures -------------------------------------------------------------------------------------------------------------------

/** @param {number} v @param {number} [digits] */
const fixed = (v, digits = 4) => (Object.is(v, -0) ? 0 : v).toFixed(digits);

function tell() {
  const css = (/** @type {number[]} */ rgb) => `color(${space.value} ${rgb.map((v) => v.toFixed(5)).join(" ")})`;
  part("patch", HTMLElement).style.background = css(color.coded_exact);
  part("mixed", HTMLElement).style.background = css(color.mixed_exact);
  const band = Number(field("width").value);
  const half = band / 2;
  part("patch-label", HTMLElement).textContent =
    band > 0 ? `${color.nm} nm, from ${color.nm - half} to ${color.nm + half} nm` : `${color.nm} nm`;
  part("mixed-label", HTMLElement).textContent = `mixture, coded ${color.mixed_coded.join(" ")}`;
  for (let i = 0; i < 3; i += 1) {
    part(`linear-${i}`, HTMLElement).textContent = fixed(color.linear[i]);
    part(`coded-${i}`, HTMLElement).textContent = String(color.coded[i]);
    part(`signed-${i}`, HTMLElement).textContent = fixed(color.signed[i]);
  }
  const xy = (/** @type {number[]?} */ v) => (v ? v.map((c) => c.toFixed(5)).join(", ") : "none, because the eye does not see it");
  part("figures", HTMLElement).textContent =
    `x, y: ${xy(color.xy)}; shown as ${xy(color.shown_xy)}; luminous efficacy ${color.efficacy.toPrecision(4)} lm/W`;
  const title = space.selectedOptions[0]?.textContent ?? "";
  const missing = color.outside.map((o) => `${o.channel} would have to be ${(100 * o.by).toFixed(1)} % of the brightest channel below zero`);
  const by = color.shown_apart === null ? "" : `; the shown color lies ${color.shown_apart.toFixed(4)} away in u'v'`;
  part("outside", HTMLElement).textContent =
    !color.xy ? "" : missing.length > 0 ? `Outside of ${title}: ${missing.join(", and ")}${by}.` : `Inside of ${title}${by}.`;
  part("apart", HTMLElement).textContent =
    color.mixed_apart === null ? "A mixture without light has no color." : `Your mixture is ${color.mixed_apart.toFixed(4)} from the light in u'v'.`;
  state.textContent = `${color.nm} nm`;
  document.body.dataset.nm = String(color.nm);
}

async function ask() {
  isChanged = true;
  if (isAsking) return;
  isAsking = true;
  while (isChanged) {
    isChanged = false;
    const asked = new URLSearchParams(numbers.map((name) => [name, field(name).value]));
    asked.set("space", space.value);
    asked.set("gamut", gamut.value);
    try {
      color = await get(`/color?${asked}`);
      fault.hidden = true;
      tell();
      draw();
    } catch (error) {
      fault.textContent = error instanceof Error ? error.message : String(error);
      fault.hidden = false;
    }
  }
  isAsking = false;
}

for (const name of numbers) {
  slider(name).addEventListener("input", () => {
    field(name).value = slider(name).value;
    ask();
  });
  field(name).addEventListener("input", () => {
    if (field(name).value === "") return;
    slider(name).value = field(name).value;
    ask();
  });
}
space.addEventListener("change", ask);
gamut.addEventListener("change", ask);
part("take", HTMLButtonElement).addEventListener("click", () => {
  ["r", "g", "b"].forEach((name, i) => {
    field(name).value = String(Number(color.linear[i].toFixed(5)));
    slider(name).value = field(name).value;
  });
  ask();
});
part("controls", HTMLFormElement).addEventListener("submit", (event) => event.preventDefault());

try {
  drawn = await get("/diagram");
  space.append(...drawn.spaces.map((s) => new Option(s.title, s.name)));
  await ask();
} catch (error) {
  state.textContent = "stopped";
  fault.textContent = `${error instanceof Error ? error.message : error}: start \`spectra view --color-tester\` again`;
  fault.hidden = false;
}
