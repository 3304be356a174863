// Uses the color tester as a person does: node tester.mjs FOLDER-WITH-NODE_MODULES CHROMIUM ADDRESS
import assert from "node:assert/strict";
import { findings } from "./axe.mjs";
import { driven } from "./driver.mjs";

const { folder, address, page, narrow, end } = await driven();

/** Sets a field and waits for the figures. @param {string} name @param {string} value */
const set = (name, value) => page.evaluate(async ([name, value]) => {
  const field = document.querySelector(`#${name}-field`);
  field.value = value;
  field.dispatchEvent(new Event("input"));
  const nm = document.querySelector("#nm-field").value;
  while (document.body.dataset.nm !== nm) await new Promise((done) => setTimeout(done, 1));
}, [name, value]);
const row = (name) => page.evaluate((name) => [0, 1, 2].map((i) => Number(document.querySelector(`#${name}-${i}`).textContent)), name);

await page.goto(address);
await page.waitForFunction(() => document.body.dataset.nm);

// Colors from the table of the dispersion study, linear and as encoded for a screen.
for (const [nm, linear, coded] of [
  [436, [33, 0, 255], [101, 0, 255]],
  [547, [0, 255, 0], [0, 255, 0]],
  [577, [255, 148, 0], [255, 200, 0]],
  [579, [255, 126, 0], [255, 187, 0]],
  [620, [255, 0, 0], [255, 0, 0]],
]) {
  await set("nm", String(nm));
  (await row("linear")).forEach((v, i) => assert.ok(Math.abs(255 * v - linear[i]) <= 1.01, `${nm}: ${v}`));
  (await row("coded")).forEach((v, i) => assert.ok(Math.abs(v - coded[i]) <= 1, `${nm}: ${v}`));
  assert.equal(await page.locator("#patch-label").textContent(), `${nm} nm`);
  assert.match(await page.locator("#outside").textContent(), /Outside of sRGB: .* below zero/);
}

assert.deepEqual(await findings(page, folder), []);

// At every wavelength the diagram has its label, and no two labels overlap.
const overlaps = await page.evaluate(async () => {
  const field = document.querySelector("#nm-field");
  const wrong = [];
  for (let nm = 350; nm <= 830; nm += 1) {
    field.value = String(nm);
    field.dispatchEvent(new Event("input"));
    while (document.body.dataset.nm !== String(nm)) await new Promise((done) => setTimeout(done, 0));
    const labels = [...document.querySelectorAll("#diagram text")].map((t) => [t.textContent, t.getBBox()]);
    if (!labels.some(([text]) => text === `${nm} nm`)) wrong.push(`${nm}: no label`);
    for (let i = 0; i < labels.length; i += 1) {
      for (let j = 0; j < i; j += 1) {
        const [a, b] = [labels[i][1], labels[j][1]];
        if (a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height) wrong.push(`${nm}: ${labels[i][0]}, ${labels[j][0]}`);
      }
    }
  }
  return wrong;
});
assert.deepEqual(overlaps, []);

// A larger gamut, a band, and a match.
await set("nm", "520");
await page.locator("#space").selectOption("rec2020");
await page.waitForFunction(() => /of Rec\. 2020/.test(document.querySelector("#outside").textContent));
await page.locator("#space").selectOption("srgb");
await set("width", "200");
await page.waitForFunction(() => /^Inside of sRGB/.test(document.querySelector("#outside").textContent));
await page.locator("#take").click();
await page.waitForFunction(() => /is 0\.0000 from the light/.test(document.querySelector("#apart").textContent));
await page.locator("#r").focus();
for (let i = 0; i < 20; i += 1) await page.keyboard.press("ArrowLeft");
await page.waitForFunction(() => !/is 0\.0000 from the light/.test(document.querySelector("#apart").textContent));

await narrow();
await end();
