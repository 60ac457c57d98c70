// Opens report pages in Debian's chromium and prints what a reader meets there: one line of JSON, one object per page.
// Arguments: report.html files; after --pictures FOLDER pictures of each are left there. NODE_PATH leads to playwright-core.
"use strict";
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { framed, launched, space } = require("./report_space.cjs");

const ids = (page) => page.$$eval("#table tbody tr[data-id]", (rows) => rows.map((row) => Number(row.dataset.id)));
const picked = (page) => page.$eval("#pick", (ring) => ({
  hinge: Number(ring.dataset.hinge), at: [Number(ring.getAttribute("cx")), Number(ring.getAttribute("cy"))],
  visible: ring.getAttribute("visibility") === "visible",
}));
const text = (page, selector) => page.$eval(selector, (node) => node.textContent.trim());

async function sorting(page) {
  const found = { first: await ids(page), count: await text(page, "#count") };
  const heading = page.locator("#table thead button", { hasText: "angle" });
  await heading.click();
  found.by_angle = await ids(page);
  found.aria_sort = await page.$eval('#table th[aria-sort]', (cell) => [cell.textContent, cell.getAttribute("aria-sort")]);
  await heading.click();
  found.by_angle_up = await ids(page);
  found.angles = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).hinges.angle);
  return found;
}

async function filtering(page) {
  const counts = {};
  for (const verdict of ["ok", "warn", "fail"]) {
    await page.selectOption("#by-verdict", verdict);
    counts[verdict] = Number((await text(page, "#count")).split(" ")[0]);
  }
  await page.selectOption("#by-verdict", "");
  await page.fill("#search", "#7");
  const one = await ids(page);
  await page.fill("#search", "piece 3");
  const piece = (await text(page, "#count")).split(" ")[0];
  await page.fill("#search", "no such words");
  const none = await ids(page);
  await page.fill("#search", "");
  return { counts, one, of_piece_3: Number(piece), none };
}

async function picking(page) {
  const before = await picked(page);
  const row = page.locator("#table tbody tr[data-id]").nth(4);
  const clicked = Number(await row.getAttribute("data-id"));
  await row.click();
  const found = { before, clicked, ring: await picked(page), detail: await text(page, "#detail-title") };
  found.marked = await page.$$eval("#table tr.picked", (rows) => rows.map((one) => Number(one.dataset.id)));
  found.drawn = await page.$$eval("#ligament rect.beam", (rects) => rects.map((one) => [one.width, one.height].map((side) => side.baseVal.value)));
  // By keyboard: from the row that was clicked two down, then Enter; then to the table's end.
  await page.locator("#table tr.picked").focus();
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  found.two_down = await page.evaluate(() => Number(document.activeElement.dataset.id));
  await page.keyboard.press("Enter");
  found.entered = await picked(page);
  await page.keyboard.press("End");
  found.end = await page.evaluate(() => Number(document.activeElement.getAttribute("aria-rowindex")));
  found.rows = await page.$eval("#table", (table) => Number(table.getAttribute("aria-rowcount")));
  // On the sheet: a click where the hinge entered lies, after another one was chosen. The wheel zooms in on it first: the
  // hinges of a corner lie half a millimetre apart.
  await page.locator("#zoom-fit").click();
  await page.locator("#table thead button").first().click();
  await page.locator("#table tbody tr[data-id]").first().click();
  found.other = await picked(page);
  await page.locator("#drawing").evaluate((svg) => svg.scrollIntoView({ block: "center" }));
  await page.locator("#drawing").focus();
  const spot = () => page.evaluate(([x, y]) => {
    const at = new DOMPoint(x, y).matrixTransform(document.getElementById("drawing").getScreenCTM());
    return [at.x, at.y];
  }, found.entered.at);
  await page.waitForTimeout(400);
  await framed(page);
  await page.mouse.move(...await spot());
  for (let i = 0; i < 8; i += 1) await page.mouse.wheel(0, -400);
  await page.waitForTimeout(400);
  await framed(page);
  await page.mouse.click(...await spot());
  found.on_sheet = await picked(page);
  return found;
}

async function sheet(page) {
  const view = () => page.$eval("#drawing", (svg) => svg.getAttribute("viewBox").split(" ").map(Number));
  const rest = async () => {
    await page.waitForTimeout(400);
    await framed(page);
  };
  await page.locator("#zoom-fit").click();
  await rest();
  const start = await view();
  await page.locator("#drawing").focus();
  await page.keyboard.press("+");
  await page.keyboard.press("ArrowRight");
  await rest();
  const near = await view();
  await page.keyboard.press("0");
  await rest();
  const back = await view();
  const layer = page.locator("#layers input").first();
  await layer.uncheck();
  const hidden = await page.$$eval('#drawing [display="none"]', (nodes) => nodes.length);
  await layer.check();
  const dots = await page.$$eval('[data-layer="hinges"] path', (paths) => paths.map((one) => (one.getAttribute("d").match(/M/g) || []).length));
  return { start, near, back, hidden, dots };
}

async function whatIf(page) {
  const rows = () => page.$$eval("#outcome tbody tr", (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const made = await rows();
  await page.fill("#wish-width", "0.1");
  const narrow = await rows();
  const note = await text(page, "#wish-note");
  await page.selectOption("#wish-material", { index: 1 });
  const other = await rows();
  await page.locator("#wishes button[type=reset]").click();
  await page.waitForTimeout(50);
  return { made, narrow, note, other, again: await rows() };
}

// Labels for those who hear the page.
const unnamed = (page) => page.$$eval("button, input, select, svg[role=img]", (nodes) => nodes
  .filter((node) => !(node.getAttribute("aria-label") || node.textContent.trim() || (node.labels && node.labels.length)))
  .map((node) => node.outerHTML.slice(0, 80)));

async function visit(browser, file, pictures) {
  const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
  const [complaints, requests] = [[], []];
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("dialog", (dialog) => { complaints.push("a dialog"); dialog.dismiss(); });
  page.on("request", (request) => { if (!/^(file|data):/.test(request.url())) requests.push(request.url()); });
  const address = pathToFileURL(file).href;
  const begun = Date.now();
  await page.goto(address);
  const found = { seconds: (Date.now() - begun) / 1000, bytes: fs.statSync(file).size };
  found.title = await page.title();
  found.job = await text(page, "#job");
  found.verdict = [await page.$eval("#verdict", (node) => node.className), await text(page, "#verdict")];
  found.foreign = await page.$$eval("body script", (nodes) => nodes.length) - 3;
  if (pictures) await leavePictures(page, path.join(pictures, path.basename(path.dirname(file))));
  found.sorting = await sorting(page);
  found.filtering = await filtering(page);
  found.picking = await picking(page);
  found.sheet = await sheet(page);
  found.what_if = await whatIf(page);
  found.unnamed = await unnamed(page);
  const steps = [];
  for (let i = 0; i < 5; i += 1) {
    const start = Date.now();
    await page.$eval("#scroller", (node, part) => { node.scrollTop = part * node.scrollHeight; }, i / 5);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    steps.push(Date.now() - start);
  }
  found.scroll_ms = steps;
  found.rows_present = (await ids(page)).length;
  found.space = await space(page);
  await page.close();
  return { ...found, complaints, requests };
}

// The first page once more, in a browser that has no WebGL.
async function withoutWebgl(file) {
  const browser = await launched(["--disable-3d-apis"]);
  const page = await browser.newPage();
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.goto(pathToFileURL(file).href);
  await page.locator("#space").scrollIntoViewIfNeeded();
  await page.locator("#space-missing").waitFor({ timeout: 10000 });
  const found = { says: await text(page, "#space-missing"), rows: (await ids(page)).length };
  found.figure = await page.locator("#space-figure").isVisible();
  await page.locator("#table tbody tr[data-id]").nth(2).click();
  await browser.close();
  return { ...found, complaints };
}

async function leavePictures(page, base) {
  for (const scheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme: scheme });
    await page.screenshot({ path: `${base}-${scheme}.png`, fullPage: true });
  }
  await page.emulateMedia({ colorScheme: "light" });
  await page.pdf({ path: `${base}.pdf`, format: "A4" });
}

async function main() {
  const files = process.argv.slice(2);
  const at = files.indexOf("--pictures");
  const pictures = at >= 0 ? files.splice(at, 2)[1] : null;
  const browser = await launched();
  const found = [];
  for (const file of files) found.push(await visit(browser, path.resolve(file), pictures));
  await browser.close();
  found.push(await withoutWebgl(path.resolve(files[0])));
  process.stdout.write(`${JSON.stringify(found)}\n`);
}

main().catch((error) => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
