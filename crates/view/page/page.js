// @ts-check
// The page of `spectra view`: a picture that follows the controls beside it.
//
// Pictures arrive as linear light in sRGB primaries. Brightness, false color, zoom, A and B and the histogram are computed from it here;
// only changes of the scene go to the server.

/** @typedef {{is: "number", before: string, unit: string, least: number?, most: number?, whole: boolean}} NumberKind */
/** @typedef {{is: "pair", unit: string, least: number?, most: number?}} PairKind */
/** @typedef {{word: string, title: string, iso: number?, kind: "color" | "slide" | "gray"}} Tile */
/** @typedef {{is: "choice", words: string[], tiles?: Tile[]}} ChoiceKind */
/** @typedef {{is: "switch"}} SwitchKind */
/** @typedef {{path: string, kind: NumberKind | PairKind | ChoiceKind | SwitchKind, value: any, help: string, front: boolean, fixed?: string?, from?: number?}} Control */
/** @typedef {{name: string, controls: Control[], widths: number[], width?: number, saves: boolean, changes: number, undos?: number, turns?: number, refused?: Record<string, {faults: Fault[]}>, is_prism?: boolean, photograph?: boolean}} Said */
/** @typedef {{message: string, place?: string, hint?: string}} Fault */
/** @typedef {{frame: number, scene?: number, lens_drawn?: number, reread?: number, turns?: number, width?: number, height?: number, light?: [number, number], draft?: boolean, samples?: number, of?: number, rays?: number, since_change_ms?: number,
 *   exposure_s?: number, lens?: string, film?: string, focus?: string, flat?: boolean, left_out?: string[], warnings?: Fault[], fault?: {path: string, faults: Fault[]}?}} Head */
/** @typedef {{across: number, down: number, light: Float32Array}} Light */
/**
 * A picture and its light; the light of a draft has fewer pixels than the whole picture.
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
const badge = part("badge", HTMLElement);
const undo = part("undo", HTMLButtonElement);
const open = part("open", HTMLSelectElement);

let desk = 0;
/** @type {Picture?} */
let now = null;
/** @type {Picture?} */
let kept = null;
let keptIsShown = false;
let view = { zoom: 1, x: 0, y: 0 };
/** Changes to send, by path, the last value of each; they are sent one after the other. @type {Map<string, any>} */
const turned = new Map();
/** Changes that were sent and are not applied yet, by path: their numbers among all changes. @type {Map<string, number>} */
const sent = new Map();
/** Refused changes, by path, with the errors. Such a field stays red and keeps what was typed until it is changed again or given up. @type {Map<string, Fault[]>} */
const refused = new Map();
let isSending = false;
/** Current state of the scene's controls. @type {Said?} */
let said = null;

/** @param {string} path @param {any} [body] */
async function post(path, body) {
  const answer = await fetch(path, { method: "POST", body: body === undefined ? undefined : JSON.stringify(body) });
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.status === 204 ? null : answer.json();
}

/** @param {string} path @param {any} value */
function turn(path, value) {
  turned.set(path, value);
  refused.delete(path);
  sync();
  state.textContent = "tracing";
  if (!isSending) send();
}

async function send() {
  isSending = true;
  while (turned.size > 0) {
    const [[path, value]] = turned;
    turned.delete(path);
    try {
      // Until its number is known, the change counts as not applied.
      sent.set(path, Infinity);
      const answer = await post(`/turn?desk=${desk}`, { path, value });
      // An answer without a number means that the change is applied.
      if (Number.isFinite(answer?.turn)) sent.set(path, answer.turn);
      else sent.delete(path);
    } catch (error) {
      sent.delete(path);
      if (!turned.has(path)) refuse(path, [{ message: error instanceof Error ? error.message : String(error) }]);
    }
  }
  isSending = false;
  refresh().catch(() => {});
}

/** Marks the value of a control as refused; its field becomes red. @param {string} path @param {Fault[]} faults */
function refuse(path, faults) {
  refused.set(path, faults);
  sync();
}

// The picture -------------------------------------------------------------------------------------------------------------------

/** sRGB codes of 4096 levels of light, IEC 61966-2-1. */
const codes = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});
/** Values of all 16-bit floats (IEEE 754 binary16), by their bits. */
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
/** The part of the picture that `inked` holds, in pixels of its level. */
let inkedPart = { x: 0, y: 0, across: 0, down: 0, level: 0 };
let isInked = false;

/** @param {number} v */
const code = (v) => codes[v >= 1 ? 4096 : v > 0 ? (4096 * v) | 0 : 0];

/**
 * Returns the light of a picture reduced by 2^level, each pixel the mean of those that it covers. Levels are made when first needed.
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

/** Draws the visible part of a picture into `inked`, no finer than it is shown. @param {Picture} picture @param {number} scale pixels of the canvas per pixel of the picture */
function ink(picture, scale) {
  const finest = Math.max(0, Math.floor(Math.log2(picture.across / (picture.width * scale))));
  const level = Math.min(finest, 12);
  const { across, down, light } = lightOf(picture, level);
  const [perX, perY] = [across / picture.width, down / picture.height];
  // One more pixel on each side, for smoothing.
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

/** Number of pixels that are enough for the shape of a histogram. */
const COUNTED = 200_000;

/** Counts the codes of a picture, of a large one only for every n-th pixel. @param {Picture} picture */
function count(picture) {
  const { light, across } = picture;
  const gain = 2 ** Number(stops.value);
  const counts = [0, 1, 2].map(() => new Uint32Array(256));
  const [reds, greens, blues] = counts;
  let step = Math.max(1, Math.round(light.length / 3 / COUNTED));
  // The step must not divide the width, so that all columns are counted.
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
  // The first and the last bin hold clipped values, which would flatten all others.
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

/** Renders the picture and its histogram again, then draws them. */
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
    // A tall picture is shown whole.
    canvas.style.setProperty("--aspect", String(picture.width / picture.height));
    const across = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
    const down = Math.round((across * picture.height) / picture.width);
    if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
    const context = canvas.getContext("2d");
    if (!context) return;
    const scale = (across / picture.width) * view.zoom;
    if (!isInked) ink(picture, scale);
    // A draft is smoothed bilinearly; a better filter would take half as long as the draft itself.
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

/** Zooms around a place on the canvas. @param {number} factor @param {number} u fraction of the canvas across @param {number} v fraction down */
function zoom(factor, u = 0.5, v = 0.5) {
  const picture = shown();
  if (!picture) return;
  const [px, py] = [view.x + (u * picture.width) / view.zoom, view.y + (v * picture.height) / view.zoom];
  view.zoom = Math.min(Math.max(view.zoom * factor, 1), 64);
  view.x = px - (u * picture.width) / view.zoom;
  view.y = py - (v * picture.height) / view.zoom;
  bound();
}

/** Returns the pixel under the pointer. @param {MouseEvent} event */
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

/** @param {Fault} fault */
function line(fault) {
  const line = document.createElement("p");
  line.textContent = `${fault.place ? `${fault.place}: ` : ""}${fault.message}${fault.hint ? ` (${fault.hint})` : ""}`;
  return line;
}

/** @param {HTMLElement} to @param {Fault[]} faults */
function list(to, faults) {
  to.replaceChildren(...faults.map(line));
  to.hidden = faults.length === 0;
}

/** Errors of the scene or the server, apart from refused values. @type {Fault[]} */
let faults = [];
/** @param {Fault[]} now */
function showFault(now) {
  faults = now;
  sync();
}

/** Returns the name of a control, in a photographer's words if there are any. @param {string} path */
function named(path) {
  const known = NAMES[/** @type {keyof typeof NAMES} */ (path)];
  if (known) return known;
  const words = path.slice(path.indexOf(".") + 1).replaceAll(".", " \u203a ").replaceAll("-", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/**
 * Makes every field show what the picture has, except red fields, fields that wait for their picture, and the one being typed in.
 */
function sync() {
  const box = part("fault", HTMLElement);
  const lines = faults.map((fault) => line(fault));
  for (const [path, wrong] of refused) {
    for (const fault of wrong) {
      // The place of a value in a command line is of no use here.
      const shown = line({ ...fault, place: undefined, message: `${named(path)}: ${fault.message}` });
      const back = document.createElement("button");
      back.type = "button";
      back.textContent = `Back to ${shownValue(path)}`;
      back.addEventListener("click", () => letGo(path));
      shown.append(" ", back);
      lines.push(shown);
    }
  }
  document.body.dataset.waits = String(sent.size + turned.size);
  box.replaceChildren(...lines);
  box.hidden = lines.length === 0;
  for (const row of form.querySelectorAll("[data-path]")) {
    if (!(row instanceof HTMLElement)) continue;
    const path = String(row.dataset.path);
    const isRefused = refused.has(path);
    row.classList.toggle("refused", isRefused);
    row.classList.toggle("waits", sent.has(path) || turned.has(path));
    const why = isRefused ? (refused.get(path) ?? []).map((fault) => fault.message).join(" ") : "";
    row.title = why || row.dataset.help || "";
    for (const field of row.querySelectorAll("input, select")) {
      if (isRefused) field.setAttribute("aria-invalid", "true");
      else field.removeAttribute("aria-invalid");
    }
    if (!isRefused && !sent.has(path) && !turned.has(path)) fills.get(row)?.();
  }
}

/** Returns the value of a control in the picture, in words. @param {string} path */
function shownValue(path) {
  const control = said?.controls.find((control) => control.path === path);
  if (!control || control.value === null) return "not set";
  if (path === "film.exposure") return timeSaid(control.value);
  if (control.kind.is === "number") return `${control.kind.before}${Number(Number(control.value).toPrecision(6))}${control.kind.unit ? ` ${control.kind.unit}` : ""}`;
  return Array.isArray(control.value) ? control.value.join(", ") : String(control.value);
}

/** Gives up a refused value: the field shows what the picture has again. @param {string} path */
function letGo(path) {
  refused.delete(path);
  given.set(path, said?.refused?.[path]);
  sync();
}
/** Refusals that the user has given up, by path. @type {Map<string, any>} */
const given = new Map();

// Controls ----------------------------------------------------------------------------------------------------------------------

const groups = [
  ["picture", "Picture"], ["film", "Film"], ["lens", "Lens"], ["imager", "Frame"], ["source", "Light and subject"], ["variables", "Variables"],
  ["wavelengths", "Wavelengths"], ["render", "Render"],
];
/** Names of controls for which photographers have words. */
const NAMES = {
  picture: "Picture", "lens.file": "Lens", "lens.f-number": "Aperture", "lens.focus": "Focus", "lens.aperture": "Blades",
  "lens.aperture.blades": "Blades", "film.stock": "Film", "film.exposure": "Shutter", "film.compensation": "Exposure +/-",
  "film.metering": "Meter", "film.iso": "ISO", "film.print": "Print on", "film.paper.grade": "Paper grade", "source.illuminant": "Light",
  "imager.format": "Format",
};

/** @param {Control[]} controls */
function build(controls) {
  fills.clear();
  form.replaceChildren(...groups.flatMap(([key, title]) => {
    const own = controls.filter((control) => control.path === key || control.path.startsWith(`${key}.`));
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
      details.open = opened.has(key);
      const fill = () => {
        if (details.open) opened.add(key);
        else opened.delete(key);
        if (details.open && details.children.length === 1) details.append(...rest.map(row));
        sync();
      };
      // Rows are made when the group is opened, because hundreds of fields take time.
      details.addEventListener("toggle", fill);
      if (details.open) details.append(...rest.map(row));
      set.append(details);
    }
    return [set];
  }));
}
/** Groups whose further controls are open. @type {Set<string>} */
const opened = new Set();
/** For each row, the function that fills it with the value that the picture has. @type {Map<HTMLElement, () => void>} */
const fills = new Map();
/** Returns the current value of a control. @param {string} path */
const valueOf = (path) => said?.controls.find((control) => control.path === path)?.value ?? null;
/** Returns whether somebody is typing in a field. @param {HTMLInputElement} field */
const isTypedIn = (field) => field.dataset.typed === "true" && document.activeElement === field;

let ids = 0;
/** @param {Control} control */
function row(control) {
  const { path, kind, help } = control;
  const div = document.createElement("div");
  div.className = `control ${kind.is === "choice" || kind.is === "switch" ? "wide" : kind.is}`;
  div.dataset.path = path;
  div.dataset.help = control.fixed ? `${path}: ${control.fixed}` : `${path}: ${help}`;
  const label = document.createElement("label");
  ids += 1;
  label.htmlFor = `c${ids}`;
  label.textContent = named(path);
  div.append(label);
  const send = (/** @type {any} */ value) => turn(path, value);
  /** @type {() => void} */
  let fill = () => {};
  if (kind.is === "switch") {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.id = label.htmlFor;
    box.addEventListener("change", () => send(box.checked));
    fill = () => {
      box.checked = valueOf(path) === true;
      box.indeterminate = valueOf(path) === null;
    };
    div.append(box);
  } else if (kind.is === "choice") {
    const select = document.createElement("select");
    select.id = label.htmlFor;
    const other = new Option("not set", "");
    select.append(other, ...kind.words.map((word) => new Option(word, word)));
    select.addEventListener("change", () => select.value !== "" && send(select.value));
    const tiles = tilesOf(kind.tiles ?? [], send);
    fill = () => {
      const value = valueOf(path);
      const isKnown = value !== null && kind.words.includes(value);
      other.hidden = isKnown;
      other.textContent = value ?? "not set";
      select.value = isKnown ? value : "";
      for (const tile of tiles) {
        const isOwn = tile.value === value;
        // A newly selected tile is scrolled into view once; later scrolling by the user is left alone.
        if (isOwn && tile.getAttribute("aria-pressed") !== "true") setTimeout(() => bringIn(tile));
        tile.setAttribute("aria-pressed", String(isOwn));
      }
    };
    div.append(select);
    if (tiles.length > 0) {
      const strip = document.createElement("div");
      strip.className = "tiles";
      strip.setAttribute("role", "group");
      strip.setAttribute("aria-label", "Films");
      strip.append(...tiles);
      div.append(strip);
    }
  } else if (kind.is === "number") {
    const [fields, filled] = numberFields(control, kind, label.htmlFor, send);
    div.append(...fields);
    fill = filled;
  } else {
    const fields = [0, 1].map((i) => {
      const field = numberField(kind);
      field.setAttribute("aria-label", `${named(path)}, ${i === 0 ? "x" : "y"}`);
      field.addEventListener("change", () => {
        const both = fields.map((f) => Number(f.value));
        if (fields.every((f) => f.value !== "") && both.every(Number.isFinite)) send(both);
        else sync();
      });
      return field;
    });
    fill = () => fields.forEach((field, i) => {
      if (!isTypedIn(field)) field.value = shortly(valueOf(path)?.[i] ?? 0);
    });
    fields[0].id = label.htmlFor;
    div.append(...fields, unit(kind.unit));
  }
  div.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && refused.has(path)) letGo(path);
  });
  for (const field of div.querySelectorAll("input, select, button")) {
    if (control.fixed && "disabled" in field) field.disabled = true;
  }
  fills.set(div, () => {
    div.classList.toggle("unset", valueOf(path) === null);
    fill();
  });
  fills.get(div)?.();
  return div;
}

/** Scrolls the strip of tiles to one of them. @param {HTMLElement} tile */
function bringIn(tile) {
  const strip = tile.parentElement;
  if (strip) strip.scrollLeft += tile.getBoundingClientRect().left - strip.getBoundingClientRect().left - 40;
}

/** Makes the tiles of films that lie side by side. @param {Tile[]} tiles @param {(word: string) => void} send */
function tilesOf(tiles, send) {
  return tiles.map(({ word, title, iso, kind }) => {
    const tile = document.createElement("button");
    tile.type = "button";
    tile.className = `tile ${kind}`;
    tile.value = word;
    const name = document.createElement("span");
    name.textContent = title;
    const speed = document.createElement("small");
    speed.textContent = iso === null ? "" : `ISO ${iso}`;
    tile.append(name, speed);
    tile.title = word;
    tile.addEventListener("click", () => send(word));
    return tile;
  });
}

/** @param {string} text */
function unit(text) {
  const span = document.createElement("span");
  span.className = "unit";
  span.textContent = text;
  return span;
}

/** Returns a number as text with six digits. @param {number?} value */
const shortly = (value) => value === null ? "" : String(Number(Number(value).toPrecision(6)));

/** @param {{least: number?, most: number?, whole?: boolean}} kind */
function numberField(kind) {
  const field = document.createElement("input");
  field.type = "number";
  field.step = kind.whole ? "1" : "any";
  if (kind.least !== null) field.min = String(kind.least);
  if (kind.most !== null) field.max = String(kind.most);
  typed(field);
  return field;
}

/** Records when somebody types in a field. @param {HTMLInputElement} field */
function typed(field) {
  field.addEventListener("input", () => { field.dataset.typed = "true"; });
  field.addEventListener("change", () => { field.dataset.typed = "false"; });
  field.addEventListener("blur", () => {
    field.dataset.typed = "false";
    sync();
  });
}

/** Stops of an aperture ring, a third of a stop apart, as they are engraved. */
const STOPS = [0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9, 10, 11, 13, 14, 16, 18, 20, 22, 25, 29, 32, 36, 40, 45, 51, 57, 64];
/** Times of a shutter, a third of a stop apart, seconds: one over these numbers, then longer times. */
const SHUTTER = [8000, 6400, 5000, 4000, 3200, 2500, 2000, 1600, 1250, 1000, 800, 640, 500, 400, 320, 250, 200, 160, 125, 100, 80, 60, 50, 40, 30, 25, 20, 15, 13, 10, 8, 6, 5, 4, 3, 2.5, 2]
  .map((part) => 1 / part).concat([0.6, 0.8, 1, 1.3, 1.6, 2, 2.5, 3.2, 4, 5, 6, 8, 10, 13, 15, 20, 25, 30, 60, 120, 240, 480]);

/** Returns a time as a camera shows it. @param {number} seconds */
function timeSaid(seconds) {
  const part = 1 / seconds;
  if (seconds < 0.35 && Math.abs(part - Math.round(part)) < 1e-4 * part) return `1/${Math.round(part)} s`;
  return `${Number(seconds.toPrecision(5))} s`;
}

/** Parses `1/80 s`, `1/80` or `0.5` into seconds; NaN for anything else. @param {string} text */
function timeOf(text) {
  const found = /^\s*([0-9.]+)\s*(?:\/\s*([0-9.]+))?\s*s?\s*$/.exec(text);
  return found ? Number(found[1]) / Number(found[2] ?? 1) : NaN;
}

/**
 * Makes a slider and a field for a number. Aperture and shutter click in stops. Other values above zero without a narrow range slide by
 * factors around the current value.
 * @param {Control} control @param {NumberKind} kind @param {string} id @param {(value: number) => void} send @returns {[HTMLElement[], () => void]}
 */
function numberFields(control, kind, id, send) {
  const { path } = control;
  const isTime = path === "film.exposure" && kind.unit === "s";
  const field = numberField(kind);
  if (isTime) {
    // To a browser, `1/80 s` is not a number.
    field.type = "text";
    field.removeAttribute("step");
  }
  field.setAttribute("aria-label", named(path));
  field.placeholder = "–";
  const read = () => isTime ? timeOf(field.value) : Number(field.value);
  const show = (/** @type {number?} */ value) => { field.value = value === null ? "" : isTime ? timeSaid(value) : shortly(value); };
  const slider = document.createElement("input");
  slider.type = "range";
  slider.id = id;
  const clicks = isTime ? SHUTTER : path === "lens.f-number" ? STOPS.filter((stop) => stop >= (control.from ?? 1) * 1.02 || stop > 32) : null;
  if (clicks && !isTime && control.from) clicks.unshift(control.from);
  const isNarrow = kind.least !== null && kind.most !== null && kind.most - kind.least <= 1000;
  let around = 1, byFactors = false;
  /** @type {(v: number) => number} */
  let of = (v) => v;
  let isDragged = false;
  const place = () => {
    const own = valueOf(path);
    const value = own ?? (kind.least !== null && kind.least > 0 ? kind.least : kind.most !== null && kind.least === 0 ? kind.most / 2 : null);
    if (clicks) {
      [slider.min, slider.max, slider.step] = ["0", String(clicks.length - 1), "1"];
      of = (v) => clicks[Math.round(v)];
      const near = (/** @type {number} */ v) => Math.abs(Math.log(v / (value ?? 1)));
      slider.value = String(clicks.reduce((best, v, i) => near(v) < near(clicks[best]) ? i : best, 0));
      return;
    }
    byFactors = !isNarrow && value !== null && value > 0;
    if (byFactors) {
      around = Number(value);
      [slider.min, slider.max, slider.step] = ["-4", "4", "0.01"];
      of = (v) => Number((around * 2 ** v).toPrecision(4));
      slider.value = "0";
    } else {
      const [least, most] = isNarrow ? [Number(kind.least), Number(kind.most)] : [(value ?? 0) - 10, (value ?? 0) + 10];
      [slider.min, slider.max] = [String(least), String(most)];
      slider.step = kind.whole ? "1" : String((most - least) / 400);
      slider.value = String(value ?? Math.min(Math.max(0, least), most));
      of = (v) => v;
    }
  };
  const bounded = (/** @type {number} */ v) => {
    const inside = Math.min(Math.max(v, kind.least ?? -Infinity), kind.most ?? Infinity);
    return kind.whole ? Math.round(inside) : inside;
  };
  slider.addEventListener("pointerdown", () => { isDragged = true; });
  for (const end of ["pointerup", "pointercancel", "blur"]) {
    slider.addEventListener(end, () => {
      isDragged = false;
      sync();
    });
  }
  slider.addEventListener("input", () => {
    const next = Number(bounded(of(Number(slider.value))).toPrecision(6));
    show(next);
    send(next);
  });
  field.addEventListener("change", () => {
    const next = read();
    // Anything that is not a number goes back to the value of the picture.
    if (field.value === "" || !Number.isFinite(next)) sync();
    else send(next);
  });
  const fill = () => {
    if (!isTypedIn(field)) show(valueOf(path));
    // While it is dragged, a slider by factors keeps the value around which it started.
    if (!isDragged && document.activeElement !== slider) place();
  };
  place();
  return [[slider, field, unit(isTime ? "" : kind.unit || kind.before)], fill];
}

// Work --------------------------------------------------------------------------------------------------------------------------

/** The shape of the form, as JSON; the form is built again when it changes, since other values may bring other controls. */
let formSays = "";
async function refresh() {
  const answer = await fetch(`/controls?desk=${desk}`);
  if (!answer.ok) return;
  /** @type {Said} */
  const now = await answer.json();
  said = now;
  part("name", HTMLElement).textContent = now.name;
  document.title = `${now.name} \u2013 spectra`;
  part("study", HTMLElement).hidden = !now.is_prism;
  save.disabled = !now.saves || now.changes === 0;
  save.title = now.saves ? "" : "This scene is not a file of yours: use Save as.";
  undo.disabled = !now.undos;
  const widths = now.widths.map(String).join();
  if (width.dataset.widths !== widths) {
    width.dataset.widths = widths;
    width.replaceChildren(...now.widths.map((w) => new Option(`${w} px`, String(w))));
  }
  width.value = String(now.width ?? 480);
  // Changes up to this number are applied or refused.
  for (const [path, number] of sent) {
    if (number <= (now.turns ?? Infinity)) sent.delete(path);
  }
  for (const path of refused.keys()) {
    if (isTold.has(path) && !now.refused?.[path]) refused.delete(path);
  }
  isTold.clear();
  for (const [path, { faults }] of Object.entries(now.refused ?? {})) {
    isTold.add(path);
    if (sent.has(path) || turned.has(path)) continue;
    if (given.has(path) && JSON.stringify(given.get(path)) === JSON.stringify(now.refused?.[path])) continue;
    given.delete(path);
    refused.set(path, faults);
  }
  drawSpectra().catch(() => {});
  const shape = JSON.stringify(now.controls.map((control) => [control.path, control.kind, control.fixed, control.from]));
  if (shape !== formSays) {
    formSays = shape;
    const focused = document.activeElement?.closest(".control");
    const path = focused instanceof HTMLElement ? focused.dataset.path : undefined;
    build(now.controls);
    if (path) {
      const field = form.querySelector(`[data-path="${CSS.escape(path)}"] :is(input, select)`);
      if (field instanceof HTMLElement) field.focus({ preventScroll: true });
    }
  }
  sync();
}
/** Paths of the values that the scene refused according to the last answer. @type {Set<string>} */
const isTold = new Set();

// Spectra -----------------------------------------------------------------------------------------------------------------------

/** @typedef {{nm: number[], values: number[]}} Curve */
/** @typedef {{light: Curve & {lines: number[][]}, layers: (Curve & {name: string})[]}} Spectra */

/** Returns the color of a curve by the wavelength of its peak. @param {Curve} curve */
function tint(curve) {
  const peak = curve.nm[curve.values.indexOf(Math.max(...curve.values))] ?? 550;
  return peak < 490 ? "short" : peak < 580 ? "middle" : "long";
}

let spectraSaid = "";
/** Draws the spectrum of the light and the sensitivities of the film's layers, each scaled to its largest value. */
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
  part("spectra-said", HTMLElement).textContent = `Spectrum of the light (dashed)${names ? ` and sensitivity of ${names}` : ""}, each scaled to its largest value.`;
}

/** Draws the current lens. */
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

/** Time of the last change, ms; `readyMs` is how long the last whole picture took to prepare, ms. */
let changedAt = performance.now();
let readyMs = 0;
/** Shows the elapsed time while nothing arrives: ghosts and stars are searched for before the first ray of the whole picture. */
setInterval(() => {
  const head = now?.head;
  if (!head?.draft || head.flat || refused.size > 0 || !isDraftSeen) return;
  const waited = performance.now() - changedAt;
  const left = leftOut(head);
  const what = left ? `preparing ${left}` : "preparing the picture";
  state.textContent = `draft; ${what}, ${(waited / 1000).toFixed(0)} s${readyMs > waited ? ` of about ${Math.ceil(readyMs / 1000)} s` : ""}`;
  if (readyMs > 0) progress.value = Math.min(0.99, waited / readyMs);
  else progress.removeAttribute("value");
}, 500);
let isDraftSeen = false;

/** Returns what a picture leaves out that the whole picture will have. @param {Head} head */
const leftOut = (head) => (head.left_out ?? []).join(" and ");

/** Labels the picture as a draft, or as lacking ghosts or stars. @param {Head} head */
function mark(head) {
  const isDraft = head.draft && !head.flat;
  badge.hidden = !isDraft && !leftOut(head);
  badge.textContent = [isDraft && "draft", leftOut(head) && `without ${leftOut(head)} yet`].filter(Boolean).join(", ");
}

/** @param {Head} head */
function tell(head) {
  showFault((head.fault?.path ? [] : head.fault?.faults) ?? []);
  list(part("warnings", HTMLElement), head.warnings ?? []);
  if (head.samples !== undefined && head.of !== undefined) {
    const time = ((head.since_change_ms ?? 0) / 1000).toFixed(1);
    const rays = Number(head.rays).toLocaleString("en");
    const samples = head.draft ? "draft" : `${head.samples} of ${head.of} samples`;
    const isQuick = head.flat && head.draft;
    state.textContent = isQuick ? "developing" : head.flat ? `developed, ${time} s` : `${samples}, ${rays} rays, ${time} s`;
    progress.value = isQuick ? 0.5 : head.samples / head.of;
    if (head.draft && !head.flat) {
      if (!isDraftSeen) changedAt = performance.now();
      isDraftSeen = true;
    } else if (isDraftSeen) {
      readyMs = performance.now() - changedAt;
      isDraftSeen = false;
    }
    mark(head);
    const seconds = head.exposure_s ?? 1;
    const exposed = seconds < 0.3 ? `1/${Math.round(1 / seconds)} s` : `${Number(seconds.toPrecision(2))} s`;
    part("lens", HTMLElement).textContent = [head.lens, `focus ${head.focus}`, head.film && `${head.film}, ${exposed}`].filter(Boolean).join("; ");
  } else if (head.fault && !head.fault.path) {
    state.textContent = "the scene is not valid as it is set";
  }
}

/** @param {AbortSignal} signal */
async function follow(signal) {
  let after = 0;
  let scene = -1, lens = -1, reread = 0;
  for (;;) {
    const answer = await fetch(`/frame?desk=${desk}&after=${after}`, { signal });
    if (answer.status === 204) continue;
    if (!answer.ok) throw new Error((await answer.text()).trim());
    const bytes = await answer.arrayBuffer();
    if (signal.aborted) throw new Error("another scene was opened");
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
    // Another scene may have other controls and another lens.
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
      saved.textContent = "The scene's file was changed; the page now shows its new content.";
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

/** Key under which an undo is recorded in `sent`. */
const BACK = "back";
async function back() {
  if (undo.disabled) return;
  turned.clear();
  refused.clear();
  state.textContent = "tracing";
  sent.set(BACK, Infinity);
  sync();
  try {
    const answer = await post(`/back?desk=${desk}`);
    sent.set(BACK, answer.turn);
  } catch (error) {
    sent.delete(BACK);
    saved.textContent = error instanceof Error ? error.message : String(error);
  }
}
undo.addEventListener("click", back);
addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof HTMLInputElement && event.target.type !== "range";
  if (event.key === "z" && (event.ctrlKey || event.metaKey) && !isTyping) {
    event.preventDefault();
    back();
  }
});

/** Gives a file to the browser as a download. @param {Blob} blob @param {string} name */
function handOver(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  saved.textContent = `${name} is in the downloads of your browser.`;
}

/** Saves all pixels of the shown picture, with its brightness. */
part("save-picture", HTMLButtonElement).addEventListener("click", () => {
  const picture = shown();
  if (!picture) return;
  const { across, down, light, head } = picture;
  const whole = document.createElement("canvas");
  [whole.width, whole.height] = [across, down];
  const context = whole.getContext("2d");
  if (!context) return;
  const image = context.createImageData(across, down);
  const gain = 2 ** Number(stops.value);
  for (let i = 0, to = 0; i < light.length; i += 3, to += 4) {
    for (let c = 0; c < 3; c += 1) image.data[to + c] = code(gain * light[i + c]);
    image.data[to + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  const name = `${said?.name ?? "picture"}${head.draft ? "-draft" : ""}.png`;
  whole.toBlob((blob) => blob && handOver(blob, name), "image/png");
});

part("save-as", HTMLButtonElement).addEventListener("click", async () => {
  const answer = await fetch(`/scene?desk=${desk}`);
  const text = await answer.text();
  if (answer.ok && text) handOver(new Blob([text], { type: "text/yaml" }), `${said?.name ?? "scene"}.yaml`);
  else saved.textContent = text.trim() || "the text of this scene is not available here";
});

part("copy", HTMLButtonElement).addEventListener("click", async () => {
  const answer = await fetch(`/command?desk=${desk}`);
  if (answer.status !== 200) {
    saved.textContent = "no command is available for this here";
    return;
  }
  const { command } = await answer.json();
  // If the browser does not allow copying, the command can still be read.
  const isCopied = await navigator.clipboard?.writeText(command).then(() => true, () => false);
  saved.textContent = `${isCopied ? "Copied: " : ""}${command}`;
});

/** Fills the list of scenes and photographs that can be opened. */
async function offer() {
  if (open.options.length > 1) return;
  const answer = await fetch("/openable");
  if (answer.status !== 200) return;
  const { files, bundled } = await answer.json();
  const group = (/** @type {string} */ label, /** @type {string[]} */ names, /** @type {string} */ mark) => {
    const group = document.createElement("optgroup");
    group.label = label;
    group.append(...names.map((name) => new Option(name, `${mark}${name}`)));
    return group;
  };
  if (files.length > 0) open.append(group("This folder", files, "f"));
  open.append(group("Bundled scenes", bundled, "b"));
}
open.addEventListener("change", async () => {
  const [mark, name] = [open.value.slice(0, 1), open.value.slice(1)];
  open.value = "";
  if (!name) return;
  state.textContent = `opening ${name}`;
  try {
    const other = await post("/open", { name, bundled: mark === "b" });
    const before = desk;
    desk = other.desk;
    follows.abort();
    fetch(`/close?desk=${before}`, { method: "POST", keepalive: true });
  } catch (error) {
    showFault([{ message: error instanceof Error ? error.message : String(error) }]);
    state.textContent = `${name} cannot be opened`;
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

/** Forgets everything about the previous scene. */
function forget() {
  [now, kept, keptIsShown, formSays, spectraSaid, said, readyMs, isDraftSeen] = [null, null, false, "", "", null, 0, false];
  turned.clear();
  sent.clear();
  refused.clear();
  given.clear();
  isTold.clear();
  swap.disabled = true;
  saved.textContent = "";
  fit();
}

/** Aborts the wait for a picture of a scene that was left. */
let follows = new AbortController();
try {
  offer().catch(() => {});
  ({ desk } = await post("/open"));
  for (;;) {
    const own = desk;
    follows = new AbortController();
    try {
      await follow(follows.signal);
    } catch (error) {
      if (own === desk) throw error;
    }
    forget();
  }
} catch (error) {
  state.textContent = "stopped";
  showFault([{ message: error instanceof Error ? error.message : String(error), hint: "reload the page, or start `spectra view` again" }]);
}
