// @ts-check
// The page of `spectra view`: a picture that follows the controls beside it.
//
// Pictures come as linear light in sRGB primaries. Brightness, false color, zoom, A and B and the histogram are made of that here;
// only what changes the scene goes to the server.

/** @typedef {{is: "number", before: string, unit: string, least: number?, most: number?, whole: boolean}} NumberKind */
/** @typedef {{is: "pair", unit: string, least: number?, most: number?}} PairKind */
/** @typedef {{is: "choice", words: string[]}} ChoiceKind */
/** @typedef {{is: "switch"}} SwitchKind */
/** @typedef {{path: string, kind: NumberKind | PairKind | ChoiceKind | SwitchKind, value: any, help: string, front: boolean}} Control */
/** @typedef {{message: string, place?: string, hint?: string}} Fault */
/** @typedef {{frame: number, scene?: number, lens_drawn?: number, reread?: number, turns?: number, width?: number, height?: number, light?: [number, number], draft?: boolean, samples?: number, of?: number, rays?: number, since_change_ms?: number,
 *   exposure_s?: number, lens?: string, film?: string, focus?: string, warnings?: Fault[], fault?: {path: string, faults: Fault[]}?}} Head */
/** @typedef {{across: number, down: number, light: Float32Array}} Light */
/**
 * A picture, and its light: of a draft, fewer pixels than the picture will have.
 * @typedef {Light & {head: Head, width: number, height: number, levels?: Light[]}} Picture
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

const canvas = part("canvas", HTMLCanvasElement);
const histogram = part("histogram", HTMLCanvasElement);
const state = part("state", HTMLElement);
const progress = part("progress", HTMLProgressElement);
const readout = part("readout", HTMLElement);
const stops = part("stops", HTMLInputElement);
const show = part("show", HTMLSelectElement);
const width = part("width", HTMLSelectElement);
const keep = part("keep", HTMLButtonElement);
const swap = part("swap", HTMLButtonElement);
const save = part("save", HTMLButtonElement);
const saved = part("saved", HTMLElement);
const form = part("controls", HTMLFormElement);
const section = part("section", HTMLImageElement);

let desk = 0;
/** @type {Picture?} */
let now = null;
/** @type {Picture?} */
let kept = null;
let keptIsShown = false;
let view = { zoom: 1, x: 0, y: 0 };
/** What is to be sent, by path; sent one after the other, the last value of each. @type {Map<string, any>} */
const turned = new Map();
let isSending = false;

/** @param {string} path @param {any} [body] */
async function post(path, body) {
  const answer = await fetch(path, { method: "POST", body: body === undefined ? undefined : JSON.stringify(body) });
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.status === 204 ? null : answer.json();
}

/** @param {string} path @param {any} value */
function turn(path, value) {
  turned.set(path, value);
  state.textContent = "tracing";
  if (!isSending) send();
}

async function send() {
  isSending = true;
  while (turned.size > 0) {
    const [[path, value]] = turned;
    turned.delete(path);
    try {
      await post(`/turn?desk=${desk}`, { path, value });
    } catch (error) {
      showFault([{ message: `${path}: ${error instanceof Error ? error.message : error}` }]);
    }
  }
  isSending = false;
}

// The picture -------------------------------------------------------------------------------------------------------------------

/** sRGB codes of 4096 levels of light, IEC 61966-2-1. */
const codes = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});
/** Numbers of 16 bits, IEEE 754 binary16, as what they are. */
const halves = Float32Array.from({ length: 65536 }, (_, bits) => {
  const [exponent, rest] = [(bits >> 10) & 31, (bits & 1023) / 1024];
  const size = exponent === 31 ? (rest ? NaN : Infinity) : exponent === 0 ? rest * 2 ** -14 : (1 + rest) * 2 ** (exponent - 15);
  return bits & 32768 ? -size : size;
});
/** Colors of stops around a mid gray, as cine cameras show them: from five below to four above. */
const bands = [
  [30, 0, 60], [60, 30, 140], [50, 80, 200], [70, 130, 200], [110, 160, 180], [128, 128, 128],
  [150, 190, 110], [210, 210, 80], [235, 160, 50], [235, 90, 50], [255, 255, 255],
];

const inked = document.createElement("canvas");
/** What `inked` holds, in pixels of its level, and where that lies in it. */
let inkedPart = { x: 0, y: 0, across: 0, down: 0, level: 0 };
let isInked = false;

/** @param {number} v */
const code = (v) => codes[v >= 1 ? 4096 : v > 0 ? (4096 * v) | 0 : 0];

/**
 * The light of a picture in parts of 2^level pixels, each the mean of those that it covers; made when it is first asked for.
 * @param {Picture} picture @param {number} level @returns {Light}
 */
function lightOf(picture, level) {
  picture.levels ??= [{ across: picture.across, down: picture.down, light: picture.light }];
  while (picture.levels.length <= level) {
    const from = picture.levels[picture.levels.length - 1];
    const [across, down] = [Math.max(1, from.across >> 1), Math.max(1, from.down >> 1)];
    const light = new Float32Array(3 * across * down);
    const right = from.across > 1 ? 3 : 0, below = from.down > 1 ? 3 * from.across : 0;
    for (let y = 0, to = 0; y < down; y += 1) {
      for (let at = 6 * y * from.across, end = at + 6 * across; at < end; at += 6) {
        for (let c = at; c < at + 3; c += 1, to += 1) {
          light[to] = 0.25 * (from.light[c] + from.light[c + right] + from.light[c + below] + from.light[c + below + right]);
        }
      }
    }
    picture.levels.push({ across, down, light });
  }
  return picture.levels[level];
}

/** Inks what is seen of a picture, no finer than it is seen. @param {Picture} picture @param {number} scale pixels of the canvas to one of the picture */
function ink(picture, scale) {
  const finest = Math.max(0, Math.floor(Math.log2(picture.across / (picture.width * scale))));
  const level = Math.min(finest, 12);
  const { across, down, light } = lightOf(picture, level);
  const [perX, perY] = [across / picture.width, down / picture.height];
  // One pixel more on each side, for what smooths them.
  const x = Math.max(0, Math.floor(view.x * perX) - 1);
  const y = Math.max(0, Math.floor(view.y * perY) - 1);
  const right = Math.min(across, Math.ceil((view.x + picture.width / view.zoom) * perX) + 1);
  const below = Math.min(down, Math.ceil((view.y + picture.height / view.zoom) * perY) + 1);
  inkedPart = { x, y, across: right - x, down: below - y, level };
  if (inked.width !== inkedPart.across || inked.height !== inkedPart.down) [inked.width, inked.height] = [inkedPart.across, inkedPart.down];
  const context = inked.getContext("2d");
  if (!context) return;
  const image = context.createImageData(inkedPart.across, inkedPart.down);
  const to = new Uint32Array(image.data.buffer);
  const gain = 2 ** Number(stops.value);
  const how = show.value;
  for (let row = y, i = 0; row < below; row += 1) {
    for (let at = 3 * (row * across + x), end = at + 3 * inkedPart.across; at < end; at += 3, i += 1) {
      const r = gain * light[at], g = gain * light[at + 1], b = gain * light[at + 2];
      let color = 0;
      if (how === "picture") {
        color = (code(b) << 16) | (code(g) << 8) | code(r);
      } else {
        const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if (how === "gray") {
          color = code(luminance) * 0x10101;
        } else if (how === "false") {
          const stop = Math.round(Math.log2(Math.max(luminance, 1e-9) / 0.18));
          const band = bands[Math.min(Math.max(stop + 5, 0), 10)];
          color = (band[2] << 16) | (band[1] << 8) | band[0];
        } else if (r >= 1 || g >= 1 || b >= 1) color = 0x3c3cff;
        else if (r <= 0 || g <= 0 || b <= 0) color = 0xff5a3c;
        else color = ((code(b) >> 2) << 16) | ((code(g) >> 2) << 8) | (code(r) >> 2);
      }
      to[i] = 0xff000000 | color;
    }
  }
  context.putImageData(image, 0, 0);
  isInked = true;
}

/** So many pixels of a picture are enough for the shape of its histogram. */
const COUNTED = 200_000;

/** Counts the codes of a picture, of a large one each so many pixels. @param {Picture} picture */
function count(picture) {
  const { light, across } = picture;
  const gain = 2 ** Number(stops.value);
  const counts = [0, 1, 2].map(() => new Uint32Array(256));
  const [reds, greens, blues] = counts;
  let step = Math.max(1, Math.round(light.length / 3 / COUNTED));
  // All columns have their turn.
  while (step > 1 && across % step === 0) step += 1;
  for (let i = 0; i < light.length; i += 3 * step) {
    reds[code(gain * light[i])] += 1;
    greens[code(gain * light[i + 1])] += 1;
    blues[code(gain * light[i + 2])] += 1;
  }
  return counts;
}

/** @param {Uint32Array[]} counts */
function drawHistogram(counts) {
  const context = histogram.getContext("2d");
  if (!context) return;
  context.clearRect(0, 0, histogram.width, histogram.height);
  context.globalCompositeOperation = matchMedia("(prefers-color-scheme: dark)").matches ? "lighter" : "multiply";
  // The ends hold what is clipped: they would flatten all others.
  const most = Math.max(1, ...counts.map((c) => Math.max(...c.subarray(1, 255))));
  counts.forEach((c, i) => {
    context.fillStyle = ["#d84a42", "#3fa05a", "#4878d0"][i];
    context.beginPath();
    c.forEach((count, code) => {
      const height = Math.min(1, Math.sqrt(count / most)) * histogram.height;
      if (height > 0) context.rect(2 * code, histogram.height - height, 2, height);
    });
    context.fill();
  });
  context.globalCompositeOperation = "source-over";
}

function shown() {
  return keptIsShown && kept ? kept : now;
}

/** Inks and counts anew, then draws. */
function redraw() {
  isInked = false;
  isCounted = false;
  draw();
}

let isCounted = false;
let isAsked = false;
function draw() {
  if (isAsked) return;
  isAsked = true;
  requestAnimationFrame(() => {
    isAsked = false;
    const picture = shown();
    if (!picture) return;
    // A tall picture is seen whole.
    canvas.style.setProperty("--aspect", String(picture.width / picture.height));
    const across = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
    const down = Math.round((across * picture.height) / picture.width);
    if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
    const context = canvas.getContext("2d");
    if (!context) return;
    const scale = (across / picture.width) * view.zoom;
    if (!isInked) ink(picture, scale);
    // Of a draft, bilinear: a finer one takes as long as half of the draft itself.
    context.imageSmoothingEnabled = scale < 2 || picture.across !== picture.width;
    context.imageSmoothingQuality = "low";
    context.fillStyle = "#000";
    context.fillRect(0, 0, across, down);
    const part = inkedPart;
    const size = lightOf(picture, part.level);
    const [wide, high] = [(scale * picture.width) / size.across, (scale * picture.height) / size.down];
    context.drawImage(inked, part.x * wide - view.x * scale, part.y * high - view.y * scale, part.across * wide, part.down * high);
    if (isCounted) return;
    isCounted = true;
    // After the picture is painted.
    setTimeout(() => drawHistogram(count(picture)));
  });
}

/** Keeps the view within the picture. */
function bound() {
  const picture = shown();
  if (!picture) return;
  view.zoom = Math.min(Math.max(view.zoom, 1), 64);
  view.x = Math.min(Math.max(view.x, 0), picture.width * (1 - 1 / view.zoom));
  view.y = Math.min(Math.max(view.y, 0), picture.height * (1 - 1 / view.zoom));
  isInked = false;
  draw();
}

/** @param {number} factor @param {number} u part of the canvas across @param {number} v part of it down */
function zoom(factor, u = 0.5, v = 0.5) {
  const picture = shown();
  if (!picture) return;
  const [px, py] = [view.x + (u * picture.width) / view.zoom, view.y + (v * picture.height) / view.zoom];
  view.zoom = Math.min(Math.max(view.zoom * factor, 1), 64);
  view.x = px - (u * picture.width) / view.zoom;
  view.y = py - (v * picture.height) / view.zoom;
  bound();
}

/** The pixel under a place on the screen. @param {MouseEvent} event */
function pixelAt(event) {
  const picture = shown();
  if (!picture) return null;
  const box = canvas.getBoundingClientRect();
  const [u, v] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  const x = Math.floor(view.x + (u * picture.width) / view.zoom);
  const y = Math.floor(view.y + (v * picture.height) / view.zoom);
  return x >= 0 && y >= 0 && x < picture.width && y < picture.height ? { x, y, u, v, picture } : null;
}

let asked = 0;
/** @param {MouseEvent} event */
async function read(event) {
  const at = pixelAt(event);
  if (!at) return;
  const { x, y, picture } = at;
  const gain = 2 ** Number(stops.value);
  const column = Math.floor((x * picture.across) / picture.width);
  const at0 = 3 * (Math.floor((y * picture.down) / picture.height) * picture.across + column);
  const display = [...picture.light.subarray(at0, at0 + 3)].map((v) => codes[Math.round(4096 * Math.min(Math.max(gain * v, 0), 1))]);
  const hex = display.map((v) => v.toString(16).padStart(2, "0")).join("");
  const own = `${x}, ${y} px: display ${display.join(" ")} (#${hex})`;
  readout.textContent = own;
  if (picture === kept && keptIsShown) return;
  asked += 1;
  const mine = asked;
  await new Promise((done) => setTimeout(done, 60));
  if (mine !== asked) return;
  const answer = await fetch(`/pixel?desk=${desk}&x=${x}&y=${y}`);
  if (!answer.ok || mine !== asked) return;
  const { channels } = await answer.json();
  const said = channels.map((/** @type {any} */ c) => `${c.name} ${Number(c.value).toPrecision(4)} ${c.unit}`);
  readout.textContent = `${own}; ${said.join(", ")}`;
}

/** @type {{x: number, y: number, at: {x: number, y: number}}?} */
let dragged = null;
canvas.addEventListener("pointerdown", (event) => {
  dragged = { x: event.clientX, y: event.clientY, at: { x: view.x, y: view.y } };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const picture = shown();
  if (dragged && picture && view.zoom > 1) {
    const scale = canvas.clientWidth / picture.width * view.zoom;
    view.x = dragged.at.x - (event.clientX - dragged.x) / scale;
    view.y = dragged.at.y - (event.clientY - dragged.y) / scale;
    bound();
  } else {
    read(event);
  }
});
canvas.addEventListener("pointerup", () => { dragged = null; });
canvas.addEventListener("wheel", (event) => {
  const at = pixelAt(event);
  event.preventDefault();
  zoom(2 ** (-event.deltaY / 240), at?.u, at?.v);
}, { passive: false });
canvas.addEventListener("keydown", (event) => {
  const picture = shown();
  if (!picture) return;
  const step = picture.width / view.zoom / 8;
  const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  const move = moves[/** @type {keyof typeof moves} */ (event.key)];
  if (move) {
    [view.x, view.y] = [view.x + move[0], view.y + move[1]];
    bound();
  } else if (event.key === "+" || event.key === "=") zoom(1.5);
  else if (event.key === "-") zoom(1 / 1.5);
  else if (event.key === "0") fit();
  else return;
  event.preventDefault();
});

function fit() {
  view = { zoom: 1, x: 0, y: 0 };
  isInked = false;
  draw();
}

function swapped() {
  if (!kept) return;
  keptIsShown = !keptIsShown;
  swap.setAttribute("aria-pressed", String(keptIsShown));
  swap.textContent = keptIsShown ? "Show the scene" : "Show A";
  redraw();
}

part("fit", HTMLButtonElement).addEventListener("click", fit);
part("ones", HTMLButtonElement).addEventListener("click", () => {
  const picture = shown();
  if (picture) zoom(picture.width / (canvas.clientWidth * devicePixelRatio) / view.zoom);
});
stops.addEventListener("input", () => {
  part("stops-said", HTMLOutputElement).value = Number(stops.value).toFixed(2).replace(/\.?0+$/, "");
  redraw();
});
show.addEventListener("change", redraw);
width.addEventListener("change", () => turn("width", Number(width.value)));
keep.addEventListener("click", () => {
  kept = now;
  swap.disabled = !kept;
});
swap.addEventListener("click", swapped);
addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
  if (event.key === "b" && !isTyping && !event.ctrlKey && !event.metaKey) swapped();
});
new ResizeObserver(() => {
  isInked = false;
  draw();
}).observe(canvas);

// Faults ------------------------------------------------------------------------------------------------------------------------

/** @param {HTMLElement} to @param {Fault[]} faults */
function list(to, faults) {
  to.replaceChildren(...faults.map((fault) => {
    const line = document.createElement("p");
    line.textContent = `${fault.place ? `${fault.place}: ` : ""}${fault.message}${fault.hint ? ` (${fault.hint})` : ""}`;
    return line;
  }));
  to.hidden = faults.length === 0;
}

/** @param {Fault[]} faults */
function showFault(faults) {
  list(part("fault", HTMLElement), faults);
}

// Controls ----------------------------------------------------------------------------------------------------------------------

const groups = [
  ["lens", "Lens"], ["film", "Film"], ["imager", "Frame"], ["source", "Light and subject"], ["wavelengths", "Wavelengths"], ["render", "Render"],
];

/** @param {Control[]} controls */
function build(controls) {
  form.replaceChildren(...groups.flatMap(([key, title]) => {
    const own = controls.filter((control) => control.path.startsWith(`${key}.`));
    if (own.length === 0) return [];
    const set = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = title;
    set.append(legend, ...own.filter((control) => control.front).map(row));
    const rest = own.filter((control) => !control.front);
    if (rest.length > 0) {
      const details = document.createElement("details");
      const summary = document.createElement("summary");
      summary.textContent = `${rest.length} more`;
      details.append(summary);
      // Made when it is looked at: hundreds of fields cost time.
      details.addEventListener("toggle", () => {
        if (details.open && details.children.length === 1) details.append(...rest.map(row));
      });
      set.append(details);
    }
    return [set];
  }));
}

let ids = 0;
/** @param {Control} control */
function row(control) {
  const { path, kind, help } = control;
  const div = document.createElement("div");
  div.className = `control ${kind.is === "choice" || kind.is === "switch" ? "wide" : kind.is}${control.value === null ? " unset" : ""}`;
  div.dataset.path = path;
  div.title = help;
  const label = document.createElement("label");
  ids += 1;
  label.htmlFor = `c${ids}`;
  label.textContent = path === "lens.aperture" || path === "lens.aperture.blades" ? "blades" : path.slice(path.indexOf(".") + 1);
  div.append(label);
  const send = (/** @type {any} */ value) => {
    div.classList.remove("unset");
    turn(path, value);
  };
  if (kind.is === "switch") {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.id = label.htmlFor;
    box.checked = control.value === true;
    box.indeterminate = control.value === null;
    box.addEventListener("change", () => send(box.checked));
    div.append(box);
  } else if (kind.is === "choice") {
    const select = document.createElement("select");
    select.id = label.htmlFor;
    const known = control.value === null || !kind.words.includes(control.value);
    if (known) select.append(new Option(control.value ?? "not set", "", true, true));
    select.append(...kind.words.map((word) => new Option(word, word, false, word === control.value)));
    select.addEventListener("change", () => select.value !== "" && send(select.value));
    div.append(select);
  } else if (kind.is === "number") {
    div.append(...numberFields(control, kind, label.htmlFor, send));
  } else {
    const fields = [0, 1].map((i) => {
      const field = numberField(kind, control.value?.[i] ?? 0);
      field.setAttribute("aria-label", `${path}, ${i === 0 ? "x" : "y"}`);
      field.addEventListener("change", () => {
        const both = fields.map((f) => Number(f.value));
        if (both.every(Number.isFinite)) send(both);
      });
      return field;
    });
    fields[0].id = label.htmlFor;
    div.append(...fields, unit(kind.unit));
  }
  return div;
}

/** @param {string} text */
function unit(text) {
  const span = document.createElement("span");
  span.className = "unit";
  span.textContent = text;
  return span;
}

/** @param {{least: number?, most: number?, whole?: boolean}} kind @param {number?} value */
function numberField(kind, value) {
  const field = document.createElement("input");
  field.type = "number";
  field.step = kind.whole ? "1" : "any";
  if (kind.least !== null) field.min = String(kind.least);
  if (kind.most !== null) field.max = String(kind.most);
  field.value = value === null ? "" : String(Number(Number(value).toPrecision(6)));
  return field;
}

/**
 * A slider and a field. What is above zero and has no narrow range slides by factors, around where it stands.
 * @param {Control} control @param {NumberKind} kind @param {string} id @param {(value: number) => void} send
 */
function numberFields(control, kind, id, send) {
  const value = control.value ?? (kind.least !== null && kind.least > 0 ? kind.least : kind.most !== null && kind.least === 0 ? kind.most / 2 : null);
  const field = numberField(kind, control.value);
  field.setAttribute("aria-label", control.path);
  const slider = document.createElement("input");
  slider.type = "range";
  slider.id = id;
  const isNarrow = kind.least !== null && kind.most !== null && kind.most - kind.least <= 1000;
  const byFactors = !isNarrow && value !== null && value > 0;
  const around = byFactors ? Number(value) : 1;
  /** @type {(v: number) => number} */
  let of = (v) => v;
  if (byFactors) {
    [slider.min, slider.max, slider.step] = ["-4", "4", "0.01"];
    of = (v) => Number((around * 2 ** v).toPrecision(4));
    slider.value = "0";
  } else {
    const [least, most] = isNarrow ? [Number(kind.least), Number(kind.most)] : [(value ?? 0) - 10, (value ?? 0) + 10];
    [slider.min, slider.max] = [String(least), String(most)];
    slider.step = kind.whole ? "1" : String((most - least) / 400);
    slider.value = String(value ?? Math.min(Math.max(0, least), most));
  }
  const bounded = (/** @type {number} */ v) => {
    const inside = Math.min(Math.max(v, kind.least ?? -Infinity), kind.most ?? Infinity);
    return kind.whole ? Math.round(inside) : inside;
  };
  slider.addEventListener("input", () => {
    const next = bounded(of(Number(slider.value)));
    field.value = String(Number(next.toPrecision(6)));
    send(next);
  });
  field.addEventListener("change", () => {
    const next = Number(field.value);
    if (field.value === "" || !Number.isFinite(next)) return;
    slider.value = String(byFactors && next > 0 ? Math.log2(next / around) : next);
    send(next);
  });
  return [slider, field, unit(kind.unit || kind.before)];
}

// Work --------------------------------------------------------------------------------------------------------------------------

/** The lens and the shape of the form follow what was set: `lens.focus`, a map, other keys. */
let formSays = "";
async function refresh() {
  const answer = await fetch(`/controls?desk=${desk}`);
  if (!answer.ok) return;
  const said = await answer.json();
  part("name", HTMLElement).textContent = said.name;
  document.title = `${said.name} – spectra`;
  part("study", HTMLElement).hidden = !said.is_prism;
  save.disabled = !said.saves || said.changes === 0;
  if (width.options.length === 0) {
    width.append(...said.widths.map((/** @type {number} */ w) => new Option(`${w} px`, String(w), w === 480, w === 480)));
  }
  drawSpectra().catch(() => {});
  const shape = JSON.stringify(said.controls.map((/** @type {Control} */ c) => [c.path, c.kind]));
  if (shape !== formSays) {
    formSays = shape;
    const focused = document.activeElement?.closest(".control");
    const path = focused instanceof HTMLElement ? focused.dataset.path : undefined;
    build(said.controls);
    if (path) {
      const field = form.querySelector(`[data-path="${CSS.escape(path)}"] :is(input, select)`);
      if (field instanceof HTMLElement) field.focus();
    }
  }
}

// Spectra -----------------------------------------------------------------------------------------------------------------------

/** @typedef {{nm: number[], values: number[]}} Curve */
/** @typedef {{light: Curve & {lines: number[][]}, layers: (Curve & {name: string})[]}} Spectra */

/** The color of a curve by where it is highest. @param {Curve} curve */
function tint(curve) {
  const peak = curve.nm[curve.values.indexOf(Math.max(...curve.values))] ?? 550;
  return peak < 490 ? "short" : peak < 580 ? "middle" : "long";
}

let spectraSaid = "";
/** The light's spectrum and the film's layers, each by its largest value. */
async function drawSpectra() {
  const answer = await fetch(`/spectra?desk=${desk}`);
  if (!answer.ok) return;
  const text = await answer.text();
  if (text === spectraSaid) return;
  spectraSaid = text;
  /** @type {Spectra} */
  const known = JSON.parse(text);
  const figure = part("spectra", SVGSVGElement);
  const [from, to] = [known.light.nm[0], known.light.nm[known.light.nm.length - 1]];
  const x = (/** @type {number} */ nm) => 12 + (696 * (nm - from)) / (to - from);
  const y = (/** @type {number} */ v) => 172 - 160 * v;
  const put = (/** @type {string} */ name, /** @type {Record<string, string | number>} */ attributes, text = "") => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
    element.textContent = text;
    figure.append(element);
  };
  const path = (/** @type {Curve} */ curve) => `M${curve.nm.map((nm, i) => `${x(nm).toFixed(1)} ${y(curve.values[i]).toFixed(1)}`).join("L")}`;
  figure.replaceChildren();
  put("line", { class: "axis", x1: 12, x2: 708, y1: 172, y2: 172 });
  for (let nm = Math.ceil(from / 50) * 50; nm <= to; nm += 50) {
    put("line", { class: "axis", x1: x(nm), x2: x(nm), y1: 172, y2: 177 });
    if (nm % 100 === 0) put("text", { x: x(nm), y: 193, "text-anchor": "middle" }, `${nm} nm`);
  }
  if (known.light.values.some((v) => v > 0)) put("path", { class: "light", d: path(known.light) });
  for (const [nm, power] of known.light.lines) if (nm >= from && nm <= to) put("line", { class: "light", x1: x(nm), x2: x(nm), y1: 172, y2: y(power) });
  for (const layer of known.layers) put("path", { class: `layer ${tint(layer)}`, d: path(layer) });
  const names = known.layers.map((layer) => layer.name).join(", ");
  part("spectra-said", HTMLElement).textContent = `Spectrum of the light (dashed)${names ? `, and what answers to it: ${names}` : ""}; each by its largest value.`;
}

/** The lens as it is now. */
async function drawLens() {
  const ground = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const drawing = await fetch(`/section?desk=${desk}&ground=${ground}`);
  if (drawing.ok) {
    const before = section.src;
    section.src = URL.createObjectURL(await drawing.blob());
    if (before.startsWith("blob:")) URL.revokeObjectURL(before);
  }
  section.hidden = !drawing.ok;
}

/** @param {Head} head */
function tell(head) {
  showFault(head.fault?.faults ?? []);
  list(part("warnings", HTMLElement), head.warnings ?? []);
  if (head.samples !== undefined && head.of !== undefined) {
    const time = ((head.since_change_ms ?? 0) / 1000).toFixed(1);
    const rays = Number(head.rays).toLocaleString("en");
    const samples = head.draft ? "draft" : `${head.samples} of ${head.of} samples`;
    state.textContent = `${samples}, ${rays} rays, ${time} s`;
    progress.value = head.samples / head.of;
    const seconds = head.exposure_s ?? 1;
    const exposed = seconds < 0.3 ? `1/${Math.round(1 / seconds)} s` : `${Number(seconds.toPrecision(2))} s`;
    part("lens", HTMLElement).textContent = [head.lens, `focus ${head.focus}`, head.film && `${head.film}, ${exposed}`].filter(Boolean).join("; ");
  } else if (head.fault) {
    state.textContent = "the scene cannot be as it is set";
  }
}

async function follow() {
  let after = 0;
  let scene = -1, lens = -1, reread = 0;
  for (;;) {
    const answer = await fetch(`/frame?desk=${desk}&after=${after}`);
    if (answer.status === 204) continue;
    if (!answer.ok) throw new Error((await answer.text()).trim());
    const bytes = await answer.arrayBuffer();
    const length = new DataView(bytes).getUint32(0, true);
    /** @type {Head} */
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
    after = head.frame;
    if (head.width !== undefined && head.height !== undefined) {
      const coded = new Uint16Array(bytes, 4 + length);
      const light = new Float32Array(coded.length);
      for (let i = 0; i < light.length; i += 1) light[i] = halves[coded[i]];
      const [across, down] = head.light ?? [head.width, head.height];
      const isOther = now?.width !== head.width;
      now = { head, width: head.width, height: head.height, across, down, light };
      if (isOther) fit();
      if (!keptIsShown) redraw();
    }
    tell(head);
    // The first picture of another scene: it may have other controls and another lens.
    if (head.scene !== undefined && head.scene !== scene) {
      scene = head.scene;
      refresh().catch(() => {});
    }
    if (head.lens_drawn !== undefined && head.lens_drawn !== lens) {
      lens = head.lens_drawn;
      drawLens().catch(() => {});
    }
    if (head.reread !== undefined && head.reread > reread) {
      reread = head.reread;
      saved.textContent = "The scene's file was saved: this is what it says now.";
    }
    document.body.dataset.frame = String(head.frame);
    if (head.turns !== undefined) document.body.dataset.turns = String(head.turns);
    document.body.dataset.draft = String(head.draft === true);
  }
}

save.addEventListener("click", async () => {
  try {
    const { saved: count } = await post(`/save?desk=${desk}`);
    saved.textContent = count === 1 ? "1 value written to the scene." : `${count} values written to the scene.`;
    save.disabled = true;
  } catch (error) {
    saved.textContent = error instanceof Error ? error.message : String(error);
  }
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  redraw();
  drawLens().catch(() => {});
});
addEventListener("pagehide", () => {
  if (desk) fetch(`/close?desk=${desk}`, { method: "POST", keepalive: true });
});
addEventListener("pageshow", (event) => event.persisted && location.reload());
form.addEventListener("submit", (event) => event.preventDefault());

try {
  ({ desk } = await post("/open"));
  await follow();
} catch (error) {
  state.textContent = "stopped";
  showFault([{ message: error instanceof Error ? error.message : String(error), hint: "reload the page, or start `spectra view` again" }]);
}
