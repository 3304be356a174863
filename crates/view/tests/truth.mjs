// Checks that the page tells the truth: node truth.mjs FOLDER CHROMIUM ADDRESS CHANGES [PICTURE.png]
//
// Makes CHANGES scripted changes, some with values that are refused or out of range. After each, every field of the page must show what
// the server's scene has, or be red with its error reported. Prints how long changes took to be seen.
import assert from "node:assert/strict";
import { driven } from "./driver.mjs";

const { address, more: [changes, picture], page, errors, browser } = await driven();
const began = Date.now();
await page.goto(address);
await page.waitForFunction(() => document.querySelectorAll("[data-path]").length > 0 && Number(document.body.dataset.frame ?? 0) > 0);
const opened = Date.now() - began;

let seed = 20261128;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;

/** Paths of the controls that can be changed. */
const paths = await page.evaluate(() => [...document.querySelectorAll("[data-path]")]
  .filter((row) => !row.querySelector(":disabled")).map((row) => row.dataset.path).filter((path) => !/^render\.|^wavelengths\./.test(path)));

/** Changes a control to a usual or an impossible value, and returns the value. */
const change = (path, how) => page.evaluate(([path, how]) => {
  const row = document.querySelector(`[data-path="${path}"]`);
  const field = row?.querySelector("input[type=number], input[type=text], select, input[type=checkbox]");
  if (field instanceof HTMLSelectElement) {
    const words = [...field.options].filter((option) => option.value !== "" && option.value !== field.value);
    if (words.length === 0) return null;
    field.value = words[Math.floor(how * words.length)].value;
  } else if (field instanceof HTMLInputElement && field.type === "checkbox") {
    field.checked = !field.checked;
  } else if (field instanceof HTMLInputElement) {
    const now = Number(field.value) || 1;
    const values = [now * (0.7 + how), -1e9, 1e9, 0.01, now * 1.3, 0, 1e-6, now, Math.round(now) + 1];
    field.value = String(values[Math.floor(how * 997) % values.length]);
  } else return null;
  field.dispatchEvent(new Event("change", { bubbles: true }));
  return field.type === "checkbox" ? String(field.checked) : field.value;
}, [path, how]);

/** Returns the fields that show another value than the scene has and are not red. Call it when no change is pending. */
const lies = () => page.evaluate(async () => {
  const address = performance.getEntriesByType("resource").map((entry) => entry.name).filter((name) => name.includes("/controls?desk=")).pop();
  const said = await (await fetch(address)).json();
  const all = [];
  for (const row of document.querySelectorAll("[data-path]")) {
    const control = said.controls.find((control) => control.path === row.dataset.path);
    if (!control) all.push(`${row.dataset.path}: the scene has no such control`);
    if (!control || row.classList.contains("refused")) continue;
    const wanted = control.value;
    for (const [i, field] of [...row.querySelectorAll("input:not([type=range]), select")].entries()) {
      const own = Array.isArray(wanted) ? wanted[i] : wanted;
      if (field.type === "checkbox") {
        if (own !== null && field.checked !== own) all.push(`${row.dataset.path}: ${field.checked}, not ${own}`);
      } else if (field.type === "number" || field.type === "text") {
        const parts = field.value.replace(/ s$/, "").split("/");
        const shown = Number(parts[0]) / Number(parts[1] ?? 1);
        const isSame = own === null ? field.value === "" || control.kind.is === "pair" : Math.abs(shown - own) <= 1e-4 * Math.abs(own);
        if (!isSame) all.push(`${row.dataset.path}: ${field.value}, not ${own}`);
      } else if (own !== null && control.kind.words.includes(own) && field.value !== own) all.push(`${row.dataset.path}: ${field.value}, not ${own}`);
    }
  }
  const red = document.querySelectorAll(".control.refused").length;
  if (red > 0 && document.querySelector("#fault").hidden) all.push("a red field is not told");
  return { all, red };
});
const calm = () => page.waitForFunction(() => document.body.dataset.waits === "0");

let red = 0;
const times = [];
for (let i = 0; i < Number(changes); i += 1) {
  const path = paths[Math.floor(random() * paths.length)];
  const from = Date.now();
  const before = await page.evaluate(() => Number(document.body.dataset.turns ?? 0));
  const value = await change(path, random());
  if (value === null) continue;
  // A value that is not a number goes back at once.
  const isBack = await page.evaluate((path) => document.body.dataset.waits === "0" && !document.querySelector(`[data-path="${path}"]`).classList.contains("refused"), path);
  if (isBack) {
    const found = await lies();
    assert.deepEqual(found.all, [], `after ${path} = ${value}`);
    continue;
  }
  // The change is seen, at least in a draft, or refused.
  await page.waitForFunction(([path, before]) => Number(document.body.dataset.turns ?? 0) > before
    || document.querySelector(`[data-path="${path}"]`)?.classList.contains("refused"), [path, before]).catch(() => {});
  times.push(Date.now() - from);
  if (Date.now() - from > 1500) console.log(`slow: ${path} = ${value}: ${Date.now() - from} ms, ${await page.locator("#state").textContent()}, ${await page.locator("#fault").textContent()}`);
  await calm();
  const found = await lies();
  assert.deepEqual(found.all, [], `after ${path} = ${value}`);
  red += found.red;
  // An undo while a field may be red: the field stays red, or tells the truth.
  if (random() < 0.3) {
    await page.locator("#undo:enabled").click({ timeout: 500 }).catch(() => {});
    await page.waitForTimeout(300);
    await calm();
    assert.deepEqual((await lies()).all, [], "after a step back");
  }
}
times.sort((a, b) => a - b);
const of = (part) => times[Math.min(times.length - 1, Math.floor(part * times.length))];
console.log(`opened ${opened} ms; ${times.length} changes: median ${of(0.5)} ms, 95 % ${of(0.95)} ms, longest ${times.at(-1)} ms; ${red} red`);
if (picture) await page.screenshot({ path: picture });
// A value out of range is answered with 400, which the browser logs as an error.
assert.deepEqual(errors.filter((text) => !/status of 400/.test(text)), []);
await browser.close();
