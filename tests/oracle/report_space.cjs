// What the view in space of a report shows and does, read from the pixels of its canvas.
"use strict";
const fs = require("fs");
const { chromium } = require("playwright-core");

// WebGL in software, the same on every machine.
const launched = (more = []) => chromium.launch({
  executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", ...more],
});

// What was asked for is drawn.
const framed = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// Keeps the canvas's pixels (or those of a picture of it) in the page under a name, and tells which part of them is covered.
async function look(page, name, from = "space-canvas") {
  await framed(page);
  return page.evaluate(([key, id]) => {
    const seen = document.getElementById(id);
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [seen.naturalWidth ?? seen.width, seen.naturalHeight ?? seen.height];
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(seen, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    window.looks = { ...window.looks, [key]: { data, width: copy.width, ratio: copy.width / seen.clientWidth } };
    let covered = 0;
    for (let i = 3; i < data.length; i += 4) covered += data[i] > 0 ? 1 : 0;
    return covered / (data.length / 4);
  }, [name, from]);
}

// The share of pixels in which two looks differ.
const differing = (page, names) => page.evaluate(([a, b]) => {
  const [one, other] = [window.looks[a], window.looks[b]];
  let count = 0;
  for (let i = 0; i < one.data.length; i += 4) {
    const off = Math.max(...[0, 1, 2, 3].map((k) => Math.abs(one.data[i + k] - other.data[i + k])));
    if (off >= 24) count += 1;
  }
  return count / (one.data.length / 4);
}, names);

const words = (page) => page.$eval("#space-says", (node) => node.textContent);
const pickedRow = (page) => page.$eval("#pick", (ring) => Number(ring.dataset.hinge));

async function slide(page, value) {
  await page.locator("#space-slider").fill(String(value));
  await framed(page);
}

// Both ends, the middle, and every way of colouring.
async function states(page) {
  const found = { words: [], targets: await page.locator("#space-target").isVisible() };
  if (found.targets) await page.locator("#space-target").uncheck();
  for (const [name, value] of [["closed", 0], ["half", 500], ["open", 1000]]) {
    await slide(page, value);
    found[name] = await look(page, name);
    found.words.push(await words(page));
  }
  found.closed_open = await differing(page, ["closed", "open"]);
  found.closed_half = await differing(page, ["closed", "half"]);
  found.half_open = await differing(page, ["half", "open"]);
  await page.locator("#space-axes").uncheck();
  await look(page, "no axes");
  found.axes = await differing(page, ["open", "no axes"]);
  await page.locator("#space-axes").check();
  if (found.targets) {
    await page.locator("#space-target").check();
    await look(page, "with target");
    found.target = await differing(page, ["open", "with target"]);
    await page.locator("#space-target").uncheck();
  }
  found.colours = [];
  const ways = await page.$$eval("#space-colour option", (all) => all.map((one) => [one.value, one.textContent]));
  for (const [value, name] of ways) {
    await page.selectOption("#space-colour", value);
    await look(page, "coloured");
    found.colours.push([name, await differing(page, ["open", "coloured"])]);
  }
  await page.selectOption("#space-colour", "0");
  // What is printed: the open state, whatever the slider shows.
  await slide(page, 0);
  await page.locator("#space-still").evaluate((still) => new Promise((made) => {
    still.addEventListener("load", made, { once: true });
    setTimeout(made, 15000);
  }));
  await look(page, "still", "space-still");
  found.still = await differing(page, ["open", "still"]);
  return found;
}

// From above and without perspective, as the sheet is cut: where rows that are clicked light up, and what clicks there choose.
async function picks(page) {
  const cut = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).space.rest.step > 0);
  await slide(page, cut ? 1000 : 0);
  const canvas = page.locator("#space-canvas");
  await canvas.focus();
  for (let i = 0; i < 20; i += 1) await page.keyboard.press("ArrowUp");
  if (!await page.locator("#space-flat").isChecked()) await page.keyboard.press("o");
  await page.keyboard.press("f");
  const rows = page.locator("#table tbody tr[data-id]");
  // Found by its number: the rows in sight change while one scrolls.
  const ids = await rows.evaluateAll((all) => all.map((row) => Number(row.dataset.id)));
  const shown = async (id, name) => {
    await page.fill("#search", `#${id}`);
    await rows.first().click();
    await canvas.scrollIntoViewIfNeeded();
    await look(page, name);
    return pickedRow(page);
  };
  const found = [];
  for (const id of [ids[1], ids[9], ids[23]]) {
    const hinge = await shown(id, "lit");
    await shown(ids[3], "other");
    const changed = await differing(page, ["lit", "other"]);
    const at = await onlyIn(page);
    await page.mouse.click(...at);
    found.push({ hinge, changed, at, clicked: await pickedRow(page) });
  }
  await page.fill("#search", "");
  return found;
}

// The middle of what one look has of the colour that marks what is chosen, and the other has not.
const onlyIn = (page) => page.evaluate(() => {
  const [lit, other] = [window.looks.lit, window.looks.other];
  const probe = document.getElementById("space-probe");
  probe.style.color = "var(--pick)";
  const wanted = getComputedStyle(probe).color.match(/[\d.]+/g).map(Number);
  const off = (data, i) => Math.hypot(...[0, 1, 2].map((k) => data[i + k] - wanted[k]));
  let [count, x, y] = [0, 0, 0];
  for (let i = 0; i < lit.data.length; i += 4) {
    if (off(lit.data, i) > 40 || off(other.data, i) < 60) continue;
    count += 1;
    x += (i / 4) % lit.width;
    y += Math.floor(i / 4 / lit.width);
  }
  const box = document.getElementById("space-canvas").getBoundingClientRect();
  return [box.left + (x / count + 0.5) / lit.ratio, box.top + (y / count + 0.5) / lit.ratio];
});

async function keys(page) {
  const canvas = page.locator("#space-canvas");
  await slide(page, 1000);
  await canvas.focus();
  if (await page.locator("#space-flat").isChecked()) await page.keyboard.press("o");
  await page.keyboard.press("f");
  const found = { flat: [await page.locator("#space-flat").isChecked()], start: await look(page, "start") };
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowDown");
  await look(page, "turned");
  found.turned = await differing(page, ["start", "turned"]);
  for (let i = 0; i < 3; i += 1) await page.keyboard.press("-");
  found.far = await look(page, "far");
  await page.keyboard.press("f");
  found.fitted = await look(page, "fitted");
  await page.keyboard.press("o");
  await look(page, "flat");
  found.flat.push(await page.locator("#space-flat").isChecked(), await differing(page, ["fitted", "flat"]));
  await page.keyboard.press("o");
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.keyboard.press(" ");
  await framed(page);
  found.calm = await words(page);
  await page.emulateMedia({ reducedMotion: null });
  await page.keyboard.press(" ");
  await page.waitForTimeout(700);
  found.playing = [await words(page), await page.$eval("#space-play", (button) => button.textContent)];
  await page.keyboard.press(" ");
  found.stopped = await page.$eval("#space-play", (button) => button.textContent);
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#space-picture").click()]);
  const picture = fs.readFileSync(await download.path());
  found.picture = [download.suggestedFilename(), picture.subarray(1, 4).toString(), picture.length, picture.readUInt32BE(16)];
  return found;
}

// Milliseconds that a move of the slider keeps the page busy, and until the picture is there.
const pace = (page) => page.evaluate(async () => {
  const slider = document.getElementById("space-slider");
  const canvas = document.getElementById("space-canvas");
  const [busy, done] = [[], []];
  for (const value of [900, 700, 500, 300, 100]) {
    const start = performance.now();
    // The page draws between these two, in the same frame.
    let drawing = 0;
    requestAnimationFrame(() => (drawing = performance.now()));
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
    const moved = performance.now() - start;
    await new Promise((drawn) => requestAnimationFrame(() => {
      busy.push(moved + performance.now() - drawing);
      setTimeout(drawn);
    }));
    canvas.getContext("webgl2").finish();
    done.push(performance.now() - start);
  }
  return { busy, done };
});

async function space(page) {
  // Smaller than a screen: a processor draws it.
  await page.setViewportSize({ width: 900, height: 720 });
  await page.evaluate(() => { document.getElementById("scroller").scrollTop = 0; });
  const started = Date.now();
  await page.locator("#space").scrollIntoViewIfNeeded();
  await page.waitForSelector("#space-canvas[data-ready]", { timeout: 60000 });
  const found = { start_ms: Date.now() - started, states: await states(page) };
  found.picks = await picks(page);
  found.keys = await keys(page);
  found.pace = await pace(page);
  return found;
}

module.exports = { framed, launched, space };
