// Uses the dispersion study as a person does: node study.mjs FOLDER-WITH-NODE_MODULES CHROMIUM ADDRESS
import assert from "node:assert/strict";
import { findings } from "./axe.mjs";
import { driven } from "./driver.mjs";

const { folder, address, page, narrow, end } = await driven();

/** Waits for a text of the state. @param {RegExp} wanted */
const says = (wanted) => page.waitForFunction((text) => new RegExp(text).test(document.querySelector("#state").textContent), wanted.source);
const drawn = () => page.locator("#rays polyline").count();
const number = (name) => page.locator(`#${name}-field`).inputValue().then(Number);

await page.goto(address);
await page.goto(new URL("/study", address).href);
await says(/^traced: 320 of 320 rays/);
assert.equal(await drawn(), 320);
assert.match(await page.locator("#said").textContent(), /bent by 66\.34.*least deviation 66\.34.* at 63\.17/);
assert.deepEqual(await findings(page, folder), []);

// When stopped, the rays stay and no new ones come; then tracing continues.
await page.locator("#light").selectOption("D65");
await page.waitForFunction(() => document.querySelectorAll("#rays polyline").length > 0);
await page.locator("#stop").click({ timeout: 5000 }).catch(() => {});
if (/^stopped/.test(await page.locator("#state").textContent())) {
  const stopped = await drawn();
  await page.waitForTimeout(300);
  assert.equal(await drawn(), stopped);
  await page.locator("#trace").click();
}
await says(/^traced/);

// Hydrogen has the lines of its table and no continuum.
await page.locator("#light").selectOption("hydrogen");
await page.waitForFunction(() => /^traced: [1-9][0-9]? of/.test(document.querySelector("#state").textContent));

// Handles are moved by dragging and by keys.
for (const [name, by] of [["beam", [0, -20]], ["apex", [-40, 0]], ["incidence", [-15, 5]], ["side", [0, 12]]]) {
  const before = await number(name);
  const box = await page.locator(`[data-moves="${name}"]`).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + by[0], box.y + box.height / 2 + by[1], { steps: 4 });
  await page.mouse.up();
  assert.notEqual(await number(name), before, name);
  const dragged = await number(name);
  // A handle keeps the keyboard focus while the figure changes under it, as it does when the drag's answer comes late.
  await page.locator(`[data-moves="${name}"]`).focus();
  const answer = page.waitForResponse(/\/rays\?.*first=0/);
  await page.locator("#light").dispatchEvent("change");
  await answer;
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(([name, before]) => Number(document.querySelector(`#${name}-field`).value) !== before, [name, dragged]);
}
await says(/^traced/);
assert.ok(await page.locator("#fault").isHidden());

// Another glass, and its angle of least deviation.
await page.locator("#glass").selectOption("SCHOTT/N-BK7");
await page.locator("#apex-field").fill("60");
await page.waitForFunction(() => /n = 1\.5168.*at 49\.3/.test(document.querySelector("#said").textContent));
await page.locator("#least").click();
await page.waitForFunction(() => /bent by 38\.6.*least deviation 38\.6/.test(document.querySelector("#said").textContent));
await narrow();
await end();
