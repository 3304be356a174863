// Random use by four pages: node random.mjs FOLDER CHROMIUM ADDRESS PID SECONDS
//
// FOLDER holds node_modules/playwright-core; PID is the server's process, whose memory, threads and child processes are read from /proc.
// What the process holds is recorded after a sixth of the time; at the end it must not hold 50 MB more, nor other threads or
// children. A full run is half an hour: SECONDS = 1800.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";

const [folder, executablePath, address, pid, seconds] = process.argv.slice(2);
const { chromium } = createRequire(`${folder}/`)("playwright-core");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
const errors = [];
const open = async (url) => {
  const page = await context.newPage();
  page.on("console", (message) => {
    // A value that the scene refuses is answered with 400, a picture that is not there yet with 404; the browser logs both.
    if (message.type() === "error" && !/status of 40[04]/.test(message.text())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => Number(document.body.dataset.frame) > 0, null, { timeout: 120_000 });
  return page;
};
const origin = new URL(address).origin;
const pages = [await open(address)];
while (pages.length < 4) pages.push(await open(origin));

let seed = 20001;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
const pick = (all) => all[Math.floor(random() * all.length)];
/** Returns the memory, threads and child processes of the server. */
const held = () => {
  const status = readFileSync(`/proc/${pid}/status`, "utf8");
  const tasks = readdirSync(`/proc/${pid}/task`);
  const children = tasks.flatMap((task) => {
    try {
      return readFileSync(`/proc/${pid}/task/${task}/children`, "utf8").trim().split(" ").filter(Boolean);
    } catch {
      return [];
    }
  });
  return { memory_mb: Number(/VmRSS:\s+(\d+)/.exec(status)[1]) / 1024, threads: tasks.length, children: children.length };
};
/** Waits until the server is idle, with whole pictures, only waiting connections, and freed memory returned; then returns what it holds. */
const rest = async () => {
  for (const page of pages) {
    await page.waitForFunction(() => document.querySelector("progress").value === 1 || !document.querySelector("#fault").hidden, null, { timeout: 300_000 }).catch(() => {});
  }
  await pages[0].waitForTimeout(4000);
  return held();
};

const acts = {
  turn: async (page) => {
    // Changes a visible control to a value that its kind allows.
    await page.evaluate(([a, b]) => {
      const rows = [...document.querySelectorAll("[data-path]")].filter((row) => !/^render\.|^wavelengths\.|threads/.test(row.dataset.path));
      const row = rows[Math.floor(a * rows.length)];
      const field = row?.querySelector("input[type=range]") ?? row?.querySelector("select, input[type=checkbox]");
      if (field instanceof HTMLSelectElement) {
        field.selectedIndex = Math.floor(b * field.options.length);
        field.dispatchEvent(new Event("change"));
      } else if (field instanceof HTMLInputElement && field.type === "range") {
        field.value = String(Number(field.min) + b * (Number(field.max) - Number(field.min)));
        field.dispatchEvent(new Event("input"));
      } else if (field instanceof HTMLInputElement) field.click();
    }, [random(), random()]);
  },
  brightness: (page) => page.evaluate((v) => {
    const field = document.querySelector("#stops");
    field.value = String(v);
    field.dispatchEvent(new Event("input"));
  }, 12 * random() - 6),
  show: (page) => page.evaluate((i) => {
    const field = document.querySelector("#show");
    field.selectedIndex = i;
    field.dispatchEvent(new Event("change"));
  }, Math.floor(4 * random())),
  point: (page) => page.mouse.move(700 * random(), 700 * random()),
  zoom: (page) => page.mouse.wheel(0, 400 * random() - 200),
  keep: (page) => page.evaluate(() => document.querySelector("#keep").click()),
  swap: (page) => page.evaluate(() => document.querySelector("#swap").click()),
  resize: (page) => page.setViewportSize({ width: 400 + Math.floor(900 * random()), height: 600 + Math.floor(400 * random()) }),
  dark: (page) => page.emulateMedia({ colorScheme: pick(["light", "dark"]) }),
  reload: async (page) => {
    await page.reload();
    await page.waitForFunction(() => Number(document.body.dataset.frame) > 0, null, { timeout: 120_000 });
  },
};
const chances = ["turn", "turn", "turn", "turn", "turn", "turn", "brightness", "show", "point", "zoom", "keep", "swap", "resize", "dark"];
const began = Date.now();
let before = null;
let count = 0;
while (Date.now() - began < 1000 * Number(seconds)) {
  const act = random() < 0.01 ? "reload" : pick(chances);
  await acts[act](pick(pages));
  count += 1;
  await pages[0].waitForTimeout(400 * random());
  if (!before && Date.now() - began > 1000 * Number(seconds) / 6) {
    // Reloading drops the changes, so that both measurements see the same scene.
    for (const page of pages) await acts.reload(page);
    before = await rest();
    console.log("after a sixth", before);
  }
}
for (const page of pages) await acts.reload(page);
let after = await rest();
// A connection that has just ended still has its thread for a moment.
for (let second = 0; second < 30 && after.threads > before.threads; second += 1) {
  await pages[0].waitForTimeout(1000);
  after = held();
}
console.log(`${count} acts in ${((Date.now() - began) / 1000).toFixed(0)} s, at the end`, after);
assert.deepEqual(errors, []);
assert.ok(after.memory_mb - before.memory_mb < 50, "memory");
assert.equal(after.threads, before.threads, "threads");
assert.equal(after.children, before.children, "child processes");
for (const page of pages) assert.notEqual(await page.locator("#state").textContent(), "stopped");
await browser.close();
