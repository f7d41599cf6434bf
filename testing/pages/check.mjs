// Opens pages in Chromium: nothing scrolls sideways at 390 px, every drawing has a text, every link goes somewhere, and axe-core finds no violation.
// node check.mjs CHROMIUM PAGE...; one line for each fault, exit code 1 if there is one.
import { existsSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { createRequire } from "node:module";
import puppeteer from "puppeteer-core";

const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const [chromium, ...pages] = process.argv.slice(2);
const browser = await puppeteer.launch({ executablePath: chromium, args: ["--no-sandbox", "--disable-gpu"] });
let faults = 0;
const fault = (text) => { faults += 1; console.log(text); };
for (const file of pages) {
  const page = await browser.newPage();
  page.on("pageerror", (error) => fault(`${file}: ${error.message}`));
  for (const width of [390, 1200]) {
    await page.setViewport({ width, height: 900 });
    await page.goto(`file://${resolve(file)}`);
    const found = await page.evaluate(() => ({
      wide: document.documentElement.scrollWidth,
      mute: [...document.querySelectorAll("svg, img")].filter((e) => !e.getAttribute("aria-label") && !e.alt).length,
      dead: [...document.links].map((a) => a.getAttribute("href"))
        .filter((to) => to.startsWith("#") && !document.getElementById(to.slice(1))),
      files: [...document.links].map((a) => a.getAttribute("href")).filter((to) => !/^(#|https?:)/.test(to)),
    }));
    if (found.wide > width) fault(`${file}: ${found.wide} px wide on a screen of ${width} px`);
    if (found.mute) fault(`${file}: ${found.mute} figures without a text`);
    for (const to of found.dead) fault(`${file}: nothing at ${to}`);
    for (const to of found.files) if (!existsSync(resolve(dirname(file), to.split("#")[0]))) fault(`${file}: no file ${to}`);
    await page.addScriptTag({ path: axe });
    const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    for (const of of violations) fault(`${file} at ${width} px: ${of.id}: ${of.help}: ${of.nodes.slice(0, 3).map((n) => n.html.slice(0, 200)).join(" | ")}`);
  }
  await page.close();
}
await browser.close();
process.exitCode = faults ? 1 : 0;
