// Measures how long a person waits for the first picture after a slider moved:
// node latency.mjs FOLDER CHROMIUM SPECTRA SCENE [EVENTS [ONLY]]
//
// ONLY is a part of the names of the controls to change. The server's CPU time per event is printed, too; it includes the work on the
// whole picture in the pauses, and can be compared even on a busy machine.
//
// FOLDER holds node_modules/playwright-core. Each event sets a control of the page as a hand does; its time ends when the browser has
// painted the first picture that has the value. Events come after random pauses of 150 to 600 ms, while other pictures are being traced.
// "Lens" is the time from that picture until the cross-section of the lens changed.
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [folder, executablePath, spectra, scene, events = "100", only = ""] = process.argv.slice(2);
const { chromium } = createRequire(`${folder}/`)("playwright-core");
const server = spawn(spectra, ["view", scene, "--no-open"], { stdio: ["ignore", "pipe", "ignore"] });
const address = await new Promise((done) => server.stdout.once("data", (d) => done(String(d).trim())));
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
let isDone = false;
const fail = (what) => {
  if (isDone) return;
  console.log(what);
  server.kill();
  process.exit(1);
};
page.on("crash", () => fail("the page crashed"));
browser.on("disconnected", () => fail("the browser ended, or was ended: a signal to this process ends it, too"));
server.on("exit", (code, signal) => fail(`the server ended: ${signal ?? code}`));
const opened = Date.now();
await page.goto(address);
await page.waitForFunction(() => Number(document.body.dataset.frame) > 0);
console.log(`page and first picture: ${Date.now() - opened} ms`);
await page.waitForTimeout(3000);

/** Returns the CPU time of the server, ms; 0 if /proc does not have it. */
const cpu = () => {
  try {
    const fields = readFileSync(`/proc/${server.pid}/stat`, "utf8").split(") ")[1].split(" ");
    return 10 * (Number(fields[11]) + Number(fields[12]));
  } catch {
    return 0;
  }
};

// A fixed seed gives the same pauses in every run.
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
/** Sets a control; returns when a picture with it was painted and, for a control of the lens, when the lens was drawn. */
const set = ([path, value]) => page.evaluate(async ([path, value]) => {
  const body = document.body;
  const painted = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
  const row = document.querySelector(`[data-path="${path}"]`) ?? document.querySelector(`[data-path="${path}.blades"]`);
  const fields = path === "width" ? [document.querySelector("#width")]
    : [...row.querySelectorAll('input[type="number"], input[type="checkbox"], select')];
  const wanted = Number(body.dataset.turns ?? 0) + 1;
  const lens = document.querySelector("#section")?.getAttribute("src");
  const start = performance.now();
  [value].flat().forEach((v, i) => { fields[i][fields[i].type === "checkbox" ? "checked" : "value"] = typeof v === "boolean" ? v : String(v); });
  fields[0].dispatchEvent(new Event("change"));
  const got = { start };
  while (!(Number(body.dataset.turns ?? 0) >= wanted)) {
    await new Promise((done) => setTimeout(done, 1));
    if (performance.now() - start > 20000) return null;
  }
  await painted();
  got.first = performance.now() - start;
  got.rays = document.querySelector("#state").textContent;
  // Other controls do not change the drawing of the lens.
  if (!path.startsWith("lens.") && path !== "film.stock") return got;
  for (const end = performance.now() + 400; document.querySelector("#section").getAttribute("src") === lens;) {
    if (performance.now() > end) return got;
    await new Promise((done) => setTimeout(done, 1));
  }
  got.lens = performance.now() - start;
  return got;
}, [path, value]);

/** Sets the brightness, which needs no request to the server; returns when it was painted. */
const brighten = (value) => page.evaluate(async (value) => {
  const stops = document.querySelector("#stops");
  const start = performance.now();
  stops.value = String(value);
  stops.dispatchEvent(new Event("input"));
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
  return { first: performance.now() - start };
}, value);

const numbers = (least, most) => () => Number((least + (most - least) * random()).toFixed(3));
const flip = () => { let on = true; return () => (on = !on); };
const word = (...words) => { let i = 0; return () => words[(i += 1) % words.length]; };
const whole = (least, most) => { let i = 0; return () => least + ((i += 1) % (most - least + 1)); };
const of = (all, part) => all.sort((a, b) => a - b)[Math.min(all.length - 1, Math.floor(part * all.length))]?.toFixed(0) ?? "-";
/** Changes a control repeatedly, and prints how long each change took. */
async function turned([path, value, count], act = set, name = path) {
  if (!name.includes(only)) return;
  const times = [], lenses = [], wholes = [], before = cpu();
  for (let i = 0; i < Number(count); i += 1) {
    const got = await act(act === set ? [path, value()] : value()).catch((error) => console.log(name, String(error).slice(0, 200)));
    if (got) times.push(got.first);
    if (got?.lens) lenses.push(got.lens - got.first);
    if (got?.whole) wholes.push(got.whole);
    await page.waitForTimeout(150 + 450 * random());
  }
  const fault = await page.locator("#fault").textContent();
  const lens = lenses.length ? `; lens after it ${of(lenses, 0.5)} ms (median), ${of(lenses, 0.95)} ms (95 %)` : "";
  const whole = wholes.length ? `; whole ${of(wholes, 0.5)} ms` : "";
  console.log(`${name}: first picture ${of(times, 0.5)} ms (median), ${of(times, 0.95)} ms (95 %), of ${times.length}${lens}${whole}; CPU ${((cpu() - before) / Number(count)).toFixed(0)} ms${fault ? `; ${fault}` : ""}`);
}

/** Opens the page again with the scene of the file, and sets these values. */
async function anew(values) {
  await page.goto(new URL("/", address).href);
  await page.waitForFunction(() => Number(document.body.dataset.frame) > 0 && document.querySelector("[data-path]"));
  for (const at of values) await set(at);
  await page.waitForTimeout(2000);
}
const [pushed, color] = [["film.stock", "kodak-tri-x-400"], ["film.stock", "kodak-gold-200"]];

for (const [values, rows] of [
  [[], [
    ["lens.f-number", numbers(2, 16), events],
    ["lens.focus", numbers(1.2, 5), events],
    ["imager.tilt", () => [numbers(-5, 5)(), numbers(-5, 5)()], events],
    ["lens.aperture", whole(5, 11), events],
  ]],
  [[], [["film.paper.grade", word("0", "1", "3", "4", "5"), events], ["film.grain", flip(), events]]],
  [[color], [["film.print", word("kodak-endura-premier", "fuji-crystal-archive-dpii"), events]]],
  [[pushed], [["film.push", word("1", "0"), events]]],
  [[], [
    ["film.stock", word("kodak-tri-x-400", "ilford-ortho-plus"), events / 4],
    ["lens.file", word("cooke-triplet-50-f5", "zeiss-biotar-50-f1.4"), events / 4],
  ]],
]) {
  const wanted = rows.filter(([path]) => path.includes(only));
  if (wanted.length > 0) await anew(values);
  for (const one of wanted) await turned(one);
}

// Waits until a picture has all its samples, or, if the scene states a noise, until it is that clean.
const ended = async (at) => {
  const got = await set(at);
  if (got) got.whole = await page.evaluate(async (start) => {
    while (!/^(\d+) of \1 samples/.test(document.querySelector("#state").textContent) && performance.now() - start < 60000) {
      await new Promise((done) => setTimeout(done, 5));
    }
    return performance.now() - start;
  }, got.start);
  return got;
};
if ("lens.f-number, all samples".includes(only)) {
  await anew([]);
  await turned(["", () => ["lens.f-number", numbers(2, 5.6)()], events / 10], ended, "lens.f-number, all samples");
}

// Changes only the development of a large picture: a small one comes first, then the whole one, and no ray is traced.
const large = async (values) => {
  await anew(values);
  await page.locator("#width").selectOption("1920");
  await page.waitForTimeout(1000);
  await page.waitForFunction(() => document.body.dataset.draft === "false", null, { timeout: 120_000 });
  await page.waitForTimeout(5000);
};
const both = async (at) => {
  const got = await set(at);
  if (got) got.whole = await page.evaluate(async (start) => {
    while (document.body.dataset.draft !== "false" && performance.now() - start < 20000) await new Promise((done) => setTimeout(done, 1));
    return performance.now() - start;
  }, got.start);
  return got;
};
for (const [values, path, value] of [
  [[], "film.paper.grade", word("1", "4")],
  [[], "film.grain", flip()],
  [[color], "film.print", word("kodak-endura-premier", "fuji-crystal-archive-dpii")],
  [[pushed], "film.push", word("1", "0")],
]) {
  const name = `${path} at 1920 px`;
  if (!name.includes(only)) continue;
  await large(values);
  await turned([path, () => [path, value()], events / 4], both, name);
}
if ("brightness at 1920 px".includes(only)) {
  await large([]);
  await turned(["", numbers(-2, 2), events], brighten, "brightness at 1920 px");
}
isDone = true;
await browser.close();
server.kill();
