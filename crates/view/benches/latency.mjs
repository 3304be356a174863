// How long a person waits for the first picture after a slider moved: node latency.mjs FOLDER CHROMIUM SPECTRA SCENE [EVENTS]
//
// FOLDER holds node_modules/playwright-core. Each event sets a control of the page as a hand does; its time ends when the browser has
// painted the first picture that has the value. Events come at random pauses of 150 to 600 ms, in the midst of whatever is traced.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";

const [folder, executablePath, spectra, scene, events = "100"] = process.argv.slice(2);
const { chromium } = createRequire(`${folder}/`)("playwright-core");
const server = spawn(spectra, ["view", scene, "--no-open"], { stdio: ["ignore", "pipe", "ignore"] });
const address = await new Promise((done) => server.stdout.once("data", (d) => done(String(d).trim())));
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
const opened = Date.now();
await page.goto(address);
await page.waitForFunction(() => Number(document.body.dataset.frame) > 0);
console.log(`page and first picture: ${Date.now() - opened} ms`);
await page.waitForTimeout(3000);

// The same pauses in every run.
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
/** Sets a control; says when a picture of it was painted and, if asked, the lens drawn. */
const set = ([path, value]) => page.evaluate(async ([path, value]) => {
  const body = document.body;
  const painted = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
  const row = document.querySelector(`[data-path="${path}"]`) ?? document.querySelector(`[data-path="${path}.blades"]`);
  const fields = path === "width" ? [document.querySelector("#width")]
    : [...row.querySelectorAll('input[type="number"], select')];
  const wanted = Number(body.dataset.turns ?? 0) + 1;
  const lens = document.querySelector("#section")?.getAttribute("src");
  const start = performance.now();
  [value].flat().forEach((v, i) => { fields[i].value = String(v); });
  fields[0].dispatchEvent(new Event("change"));
  const got = {};
  while (!(Number(body.dataset.turns ?? 0) >= wanted)) {
    await new Promise((done) => setTimeout(done, 1));
    if (performance.now() - start > 20000) return null;
  }
  await painted();
  got.first = performance.now() - start;
  got.rays = document.querySelector("#state").textContent;
  for (const end = performance.now() + 400; document.querySelector("#section").getAttribute("src") === lens;) {
    if (performance.now() > end) return got;
    await new Promise((done) => setTimeout(done, 1));
  }
  got.lens = performance.now() - start;
  return got;
}, [path, value]);

const numbers = (least, most) => () => Number((least + (most - least) * random()).toFixed(3));
const word = (...words) => { let i = 0; return () => words[(i += 1) % words.length]; };
const whole = (least, most) => { let i = 0; return () => least + ((i += 1) % (most - least + 1)); };
for (const [path, value, count] of [
  ["lens.f-number", numbers(2, 16), events],
  ["lens.focus", numbers(1.2, 5), events],
  ["imager.tilt", () => [numbers(-5, 5)(), numbers(-5, 5)()], events],
  ["lens.aperture", whole(5, 11), events],
  ["film.paper.grade", word("0", "1", "3", "4", "5"), events],
  ["film.stock", word("kodak-tri-x-400", "ilford-ortho-plus"), events / 4],
  ["lens.file", word("cooke-triplet-50-f5", "zeiss-biotar-50-f1.4"), events / 4],
]) {
  const times = [], lenses = [];
  for (let i = 0; i < Number(count); i += 1) {
    const got = await set([path, value()]).catch((error) => console.log(path, String(error).slice(0, 200)));
    if (got) times.push(got.first);
    if (got?.lens) lenses.push(got.lens - got.first);
    await page.waitForTimeout(150 + 450 * random());
  }
  const of = (all, part) => all.sort((a, b) => a - b)[Math.min(all.length - 1, Math.floor(part * all.length))]?.toFixed(0) ?? "-";
  const fault = await page.locator("#fault").textContent();
  console.log(`${path}: first picture ${of(times, 0.5)} ms (median), ${of(times, 0.95)} ms (95 %), of ${times.length}${lenses.length ? `; lens after it ${of(lenses, 0.5)} ms` : ""}${fault ? `; ${fault}` : ""}`);
}
await browser.close();
server.kill();
