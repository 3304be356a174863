// Does what a person does on the page: node browser.mjs FOLDER-WITH-NODE_MODULES CHROMIUM ADDRESS
import assert from "node:assert/strict";
import { findings } from "./axe.mjs";
import { driven } from "./driver.mjs";

const { folder, address, page, errors, narrow, end } = await driven();

/** Returns the number of the frame that is shown. */
const frame = () => page.evaluate(() => Number(document.body.dataset.frame ?? 0));
/** Waits for a picture with all its samples after this frame. @param {number} after */
const done = (after) => page.waitForFunction((after) => {
  const bar = document.querySelector("progress");
  return Number(document.body.dataset.frame ?? 0) > after && bar instanceof HTMLProgressElement && bar.value === 1;
}, after);
/** Returns the mean code of the canvas. */
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

// Drag: the f-number by its slider, with keys, as a person without a mouse does.
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

// A control that is replaced after its first value: the blades of a round stop, then of a stop with blades.
for (const blades of ["5", "6"]) {
  at = await frame();
  await page.locator('[data-path="lens.aperture"], [data-path="lens.aperture.blades"]').locator("input[type=number]").fill(blades);
  await page.keyboard.press("Enter");
  await done(at);
  await page.waitForFunction(() => document.querySelector('[data-path="lens.aperture.blades"]'));
}

// An impossible value is reported; its field stays red whatever else is changed, and the picture stays.
at = await frame();
await row("lens.f-number").locator("input[type=number]").fill("0.1");
await page.keyboard.press("Enter");
await page.waitForFunction(() => !document.querySelector("#fault").hidden);
const fault = await page.locator("#fault").textContent();
assert.match(fault, /f-number/);
assert.ok((await mean()) > 20, "the picture stays");
const isRed = () => row("lens.f-number").evaluate((row) => row.classList.contains("refused"));
assert.ok(await isRed());
await row("film.compensation").locator("input[type=number]").fill("99");
await page.keyboard.press("Enter");
await page.waitForFunction(() => document.querySelectorAll(".refused").length === 2);
assert.match(await page.locator("#fault").textContent(), /99 is out of range: it goes from -10 to 10/);
await page.keyboard.press("Escape");
await page.waitForFunction(() => document.querySelectorAll(".refused").length === 1);
assert.equal(await row("film.compensation").locator("input[type=number]").inputValue(), "");
at = await frame();
await row("film.push").locator("input[type=number]").fill("1");
await page.keyboard.press("Enter");
await done(at);
assert.ok(await isRed(), "still red");
assert.equal(await row("lens.f-number").locator("input[type=number]").inputValue(), "0.1");
// After an undo, all fields show what the picture has.
await page.locator("#undo").click();
await page.waitForFunction(() => document.querySelectorAll(".refused").length === 0 && document.body.dataset.waits === "0"
  && document.querySelector('[data-path="film.push"] input[type=number]').value === "");
assert.equal(await row("lens.f-number").locator("input[type=number]").inputValue(), "5.6");
at = await frame();
await row("lens.f-number").locator("input[type=number]").fill("5.6");
await page.keyboard.press("Enter");
await page.waitForFunction(() => document.querySelector("#fault").hidden);

// Brightness needs no request to the server.
const asked = [];
page.on("request", (request) => asked.push(request.url()));
const before = await mean();
await page.locator("#stops").fill("1");
assert.ok((await mean()) > before + 5, "a stop brighter");
assert.ok(asked.every((url) => !url.includes("/turn")), asked.join(" "));

// Comparison of A and B.
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
// Picture and control are visible together, however far down the control is.
await row("lens.f-number").evaluate((row) => row.scrollIntoView({ block: "center" }));
const seen = await page.evaluate(() => ["#stage", '[data-path="lens.f-number"]'].map((at) => document.querySelector(at).getBoundingClientRect()).map(({ top, bottom }) => [top, bottom]));
assert.ok(seen[0][0] >= -1 && seen[0][1] > 100 && seen[1][0] >= seen[0][1] && seen[1][1] <= 800, JSON.stringify(seen));
await page.setViewportSize({ width: 1280, height: 900 });

// Saved elsewhere: the picture, a scene that describes it, and a command.
for (const [button, name] of [["#save-picture", "scene.png"], ["#save-as", "scene.yaml"]]) {
  const download = page.waitForEvent("download");
  await page.locator(button).click();
  assert.equal((await download).suggestedFilename(), name);
}
await page.locator("#copy").click();
await page.waitForFunction(() => /spectra run .*scene\.yaml --set lens.f-number=f\/5.6/.test(document.querySelector("#saved").textContent));
await page.locator("#saved").evaluate((said) => { said.textContent = ""; });

await page.locator("#save").click();
await page.waitForFunction(() => document.querySelector("#saved").textContent !== "");
assert.equal(await page.locator("#saved").textContent(), "3 values written to the scene.");

// Reload shows the scene as it was saved.
await page.reload();
await done(0);
await page.waitForFunction(() => document.querySelector('[data-path="lens.f-number"] input[type=number]'));
assert.equal(await row("lens.f-number").locator("input[type=number]").inputValue(), "5.6");

// Opens another scene in the same page.
await page.locator("#open").selectOption("bgray-card");
await page.waitForFunction(() => document.querySelector("#name").textContent === "gray-card");
// A value out of range is answered with 400, which the browser logs as an error.
errors.splice(0, errors.length, ...errors.filter((text) => !/status of 400/.test(text)));
await end();
