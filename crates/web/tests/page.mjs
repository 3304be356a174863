// Tests the page without a server in Chromium: node page.mjs FOLDER-WITH-NODE_MODULES CHROMIUM FOLDER-OF-THE-PAGE [PICTURE.png]
// Checks that each scene's exposure has the bits of the command line, that the picture follows a control, and the console stays silent.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { gzipSync } from "node:zlib";

const [folder, executablePath, site, picture] = process.argv.slice(2);
const kinds = { html: "text/html", js: "text/javascript", css: "text/css", json: "application/json", wasm: "application/wasm" };
const server = createServer(async (request, response) => {
  const name = new URL(request.url, "http://here").pathname.slice(1) || "index.html";
  const bytes = /^[a-z.]+$/.test(name) ? await readFile(`${site}/${name}`).catch(() => null) : null;
  response.writeHead(bytes ? 200 : 404, { "content-type": kinds[name.split(".").pop()] ?? "text/plain" });
  response.end(bytes);
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const address = `http://127.0.0.1:${server.address().port}/`;

const module = await readFile(`${site}/spectra.wasm`);
const zipped = gzipSync(module, { level: 9 }).length;
console.log(`spectra.wasm: ${(module.length / 1e6).toFixed(1)} MB, ${(zipped / 1e6).toFixed(2)} MB gzipped`);
assert.ok(zipped < 8e6);

const { chromium } = createRequire(`${folder}/`)("playwright-core");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
page.setDefaultTimeout(120_000);
const errors = [];
page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
page.on("pageerror", (error) => errors.push(String(error)));

await page.goto(address);
/** Waits for a picture after this frame, but not for all samples, which take minutes on one thread. @param {number} after */
const drawn = (after) => page.waitForFunction((after) => Number(document.body.dataset.frame ?? 0) > after, after);
await drawn(4);
assert.ok(await page.locator("#section").isVisible(), "the lens is drawn");
assert.equal(await page.locator("#fault").isVisible(), false);
if (picture) await page.screenshot({ path: picture });

const at = await page.evaluate(() => Number(document.body.dataset.frame));
await page.locator('[data-path="lens.f-number"] input[type=number]').fill("5.6");
await page.keyboard.press("Enter");
await drawn(at + 1);

const { scenes, stages } = JSON.parse(await readFile(`${site}/fingerprints.json`, "utf8"));
assert.equal(await page.evaluate(async () => (await globalThis.spectraAbout).stages), stages, "all plugins are there");
assert.ok(Object.keys(scenes).length >= 12);
for (const [scene, known] of Object.entries(scenes)) {
  const { found, seconds } = await page.evaluate((scene) => globalThis.spectraFingerprint(scene), scene);
  console.log(`${scene}: ${found} in ${seconds.toFixed(2)} s`);
  assert.equal(found, known, scene);
}
await page.locator("#bits").click();
await page.waitForFunction(() => document.querySelector("#bits-said")?.textContent?.includes("the same bits"));
assert.deepEqual(errors, []);
await browser.close();
server.close();
