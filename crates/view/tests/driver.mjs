// Common start and end of all scripts that drive a page: node SCRIPT FOLDER-WITH-NODE_MODULES CHROMIUM ADDRESS
import assert from "node:assert/strict";
import { createRequire } from "node:module";

/** Opens a page in Chromium according to the command line, and records the errors on its console. */
export async function driven() {
  const [folder, executablePath, address, ...more] = process.argv.slice(2);
  const { chromium } = createRequire(`${folder}/`)("playwright-core");
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page.setDefaultTimeout(60_000);
  const errors = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(String(error)));
  /** Checks that nothing is wider than the window at a phone's width. */
  const narrow = async () => {
    await page.setViewportSize({ width: 400, height: 800 });
    await page.waitForTimeout(200);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 400, `${wide} px wide`);
  };
  /** Checks that there were no errors, and closes the browser. */
  const end = async () => {
    assert.deepEqual(errors, []);
    await browser.close();
  };
  return { folder, address, more, browser, page, errors, narrow, end };
}
