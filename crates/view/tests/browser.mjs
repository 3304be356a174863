// What a person does on the page: node browser.mjs FOLDER-WITH-NODE_MODULES CHROMIUM ADDRESS
import assert from "node:assert/strict";
import { findings } from "./axe.mjs";
import { driven } from "./driver.mjs";

const { folder, address, page, narrow, end } = await driven();

/** The number of the frame that is seen. */
const frame = () => page.evaluate(() => Number(document.body.dataset.frame ?? 0));
/** Waits for a picture that has all its samples, after that frame. @param {number} after */
const done = (after) => page.waitForFunction((after) => {
  const bar = document.querySelector("progress");
  return Number(document.body.dataset.frame ?? 0) > after && bar instanceof HTMLProgressElement && bar.value === 1;
}, after);
/** The mean code of what the canvas shows. */
const mean = () => page.evaluate(async () => {
  await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
  const canvas = document.querySelector("#canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return data.reduce((sum, v, i) => sum + (i % 4 === 3 ? 0 : v), 0) / (0.75 * data.length);
});
const row = (path) => page.locator(`[data-path="${path}"]`);

await page.goto(address);
await done(0);
const first = await mean();
assert.ok(first > 20 && first < 235, `a picture: ${first}`);
assert.ok(await page.locator("#section").isVisible(), "the lens is drawn");

assert.deepEqual(await findings(page, folder), []);

// Drag: the f-number by its slider, with keys as a person without a mouse does.
let at = await frame();
await row("lens.f-number").locator("input[type=range]").focus();
for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
await done(at);
assert.ok(Number(await row("lens.f-number").locator("input[type=number]").inputValue()) > 2);

// Type.
at = await frame();
await row("lens.f-number").locator("input[type=number]").fill("5.6");
await page.keyboard.press("Enter");
await done(at);

// A control that becomes another one by its first value: the blades of a round stop, and of one with blades.
for (const blades of ["5", "6"]) {
  at = await frame();
  await page.locator('[data-path="lens.aperture"], [data-path="lens.aperture.blades"]').locator("input[type=number]").fill(blades);
  await page.keyboard.press("Enter");
  await done(at);
  await page.waitForFunction(() => document.querySelector('[data-path="lens.aperture.blades"]'));
}

// A value that cannot be: it is said with its place, and the picture stays.
at = await frame();
await row("lens.f-number").locator("input[type=number]").fill("0.1");
await page.keyboard.press("Enter");
await page.waitForFunction(() => !document.querySelector("#fault").hidden);
const fault = await page.locator("#fault").textContent();
assert.match(fault, /f-number/);
assert.ok((await mean()) > 20, "the picture stays");
at = await frame();
await row("lens.f-number").locator("input[type=number]").fill("5.6");
await page.keyboard.press("Enter");
await page.waitForFunction(() => document.querySelector("#fault").hidden);

// Brightness asks nothing of the server.
const asked = [];
page.on("request", (request) => asked.push(request.url()));
const before = await mean();
await page.locator("#stops").fill("1");
assert.ok((await mean()) > before + 5, "a stop brighter");
assert.ok(asked.every((url) => !url.includes("/turn")), asked.join(" "));

// A and B.
await page.locator("#keep").click();
at = await frame();
await page.locator("#stops").fill("0");
await page.locator("#swap").click();
assert.equal(await page.locator("#swap").getAttribute("aria-pressed"), "true");
await page.locator("#swap").click();

// Values of a pixel.
await page.locator("#canvas").hover({ position: { x: 200, y: 120 } });
await page.waitForFunction(() => /display .*lx s/.test(document.querySelector("#readout").textContent));

await narrow();

await page.locator("#save").click();
await page.waitForFunction(() => document.querySelector("#saved").textContent !== "");
assert.equal(await page.locator("#saved").textContent(), "3 values written to the scene.");

// Reload: the scene as it is saved.
await page.reload();
await done(0);
await page.waitForFunction(() => document.querySelector('[data-path="lens.f-number"] input[type=number]'));
assert.equal(await row("lens.f-number").locator("input[type=number]").inputValue(), "5.6");
await end();
