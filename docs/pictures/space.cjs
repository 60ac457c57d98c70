// A picture of the view in space of a report, at a place of its slider. Arguments: report.html, 0 to 1000, picture.png.
// NODE_PATH leads to playwright-core (tests/run sets it up in target/peers/node).
"use strict";
const path = require("path");
const { pathToFileURL } = require("url");
const { launched } = require("../../tests/oracle/report_space.cjs");

async function main([report, place, picture]) {
  const browser = await launched();
  const page = await browser.newPage({ viewport: { width: 1120, height: 800 } });
  await page.goto(pathToFileURL(path.resolve(report)).href);
  await page.locator("#space").scrollIntoViewIfNeeded();
  await page.waitForSelector("#space-canvas[data-ready]");
  await page.locator("#space-slider").fill(place);
  await page.waitForTimeout(1000);
  await page.locator("#space").screenshot({ path: picture });
  await browser.close();
}

main(process.argv.slice(2));
