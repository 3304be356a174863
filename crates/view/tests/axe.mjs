// Accessibility check of a page by `axe-core`, in both color schemes and at two widths; skipped if it is not installed.
import { existsSync, readFileSync } from "node:fs";

/** Returns the violations that `axe-core` finds. @param {any} page @param {string} folder with `node_modules` */
export async function findings(page, folder) {
  const file = `${folder}/node_modules/axe-core/axe.min.js`;
  if (!existsSync(file)) {
    console.log(`skipped: ${folder} holds no node_modules/axe-core`);
    return [];
  }
  await page.evaluate(readFileSync(file, "utf8"));
  const before = page.viewportSize();
  const all = [];
  for (const colorScheme of ["light", "dark"]) {
    for (const width of [1280, 400]) {
      await page.emulateMedia({ colorScheme });
      await page.setViewportSize({ width, height: 900 });
      const { violations } = await page.evaluate(() => globalThis.axe.run());
      for (const { id, nodes } of violations) all.push(`${colorScheme}, ${width} px: ${id}: ${nodes.map((n) => n.html).join(" ")}`);
    }
  }
  await page.emulateMedia({ colorScheme: null });
  await page.setViewportSize(before);
  return all;
}
