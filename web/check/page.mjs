// Opens the page of a run in a browser and does what a person would; one line and exit code 1 for what fails.
import { mkdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { clickPoint, launch, open, readPicture, timeToFront } from "./browser.mjs";
import { MARKUP, hostileCopy } from "./hostile.mjs";
import { serve } from "./server.mjs";

/** Milliseconds in which the front must be there. */
const LOAD_LIMIT = 2000;
/** The least colours of a picture that shows a part, on a grid of 96 x 72. */
const LEAST_COLOURS = 50;
/** Milliseconds for the server to compute a shape. */
const SHAPE_LIMIT = 60000;

const WINDOWS = [
  { width: 1280, height: 800, scheme: "light" },
  { width: 1280, height: 800, scheme: "dark" },
  { width: 1920, height: 1080, scheme: "light" },
  { width: 480, height: 900, scheme: "dark" },
];

const must = (holds, line) => {
  if (!holds) throw new Error(line);
};

/** The page is quick, drawn, clickable, moving and silent; gives the load's milliseconds. */
async function checkPage(browser, url, pictures) {
  const loads = [];
  for (const window of WINDOWS) {
    const { page, complaints } = await open(browser, url, window);
    const load = await timeToFront(page);
    must(load < LOAD_LIMIT, `the front took ${load.toFixed(0)} ms, more than ${LOAD_LIMIT}`);
    loads.push(load);
    const { front } = await page.evaluate(async () => (await fetch("api/run")).json());
    must(front.length > 0, "the run has no front yet: nothing to click");
    await checkDesign(page, front[Math.floor(front.length / 2)]);
    if (window === WINDOWS[0]) await checkKeys(page, front);
    if (pictures) {
      const name = `page_${window.width}x${window.height}_${window.scheme}.png`;
      await page.evaluate(() => window.scrollTo(0, 0));
      await page.mouse.move(1, 1);
      await page.screenshot({ path: join(pictures, name) });
    }
    must(complaints.length === 0, complaints[0]);
    await page.close();
  }
  return Math.max(...loads);
}

/** A click on a design's point shows it, and playing moves it. */
async function checkDesign(page, id) {
  await page.evaluate(() => document.querySelector("#front-plot").scrollIntoView({ block: "nearest" }));
  await clickPoint(page, id);
  await shapeOf(page);
  const chosen = await page.$eval("#front-list", (list) => list.value);
  must(chosen === id, `a click on the point of ${id} chose ${chosen || "nothing"}`);
  const first = await readPicture(page);
  must(first.colours >= LEAST_COLOURS, `the picture of ${chosen} is blank: ${first.colours} colours`);
  await page.waitForFunction(() => document.querySelector("#play").textContent === "Play");
  const rest = await readPicture(page);
  await page.evaluate(() => document.querySelector("#play").click());
  await sleep(1000);
  const later = await readPicture(page);
  const moved = later.pixels.filter((value, k) => Math.abs(value - rest.pixels[k]) > 8).length;
  must(moved > 100, `the picture of ${chosen} does not move while it plays`);
  await page.evaluate(() => document.querySelector("#play").click());
}

/** Arrow keys walk along the front, B blocks, C recolours, Space plays. */
async function checkKeys(page, front) {
  const chosen = () => page.$eval("#front-list", (list) => list.value);
  const pressed = (host) => page.$eval(`${host} [aria-pressed=true]`, (button) => button.textContent);
  await page.keyboard.press("End");
  must((await chosen()) === front[0], "End does not choose the design that bends most");
  if (front.length > 1) {
    await page.keyboard.press("ArrowLeft");
    must((await chosen()) === front[1], "the left arrow does not choose the next that bends less");
  }
  await shapeOf(page);
  await page.keyboard.press("b");
  must((await pressed("#scenario")) === "Blocked", "B does not show the blocked scenario");
  await page.keyboard.press("c");
  must((await pressed("#colour")) === "Stretch", "C does not change the colour");
  const label = () => page.$eval("#play", (button) => button.textContent);
  const before = await label();
  await page.keyboard.press("Space");
  must((await label()) !== before, "Space neither plays nor pauses");
  if ((await label()) === "Play") await page.keyboard.press("Space");
  // Near the end of the path the pictures show most.
  await page.waitForFunction(() => document.querySelector("#place").value > 900);
  await page.keyboard.press("Space");
}

/** Waits until the picture is there; throws the page's own line when it says that there is none. */
async function shapeOf(page) {
  await page.waitForFunction(
    () => !document.querySelector("#play").disabled || document.querySelector("#message").textContent.startsWith("No picture"),
    { timeout: SHAPE_LIMIT },
  );
  const [none, line] = await page.evaluate(() => [
    document.querySelector("#play").disabled,
    document.querySelector("#message").textContent,
  ]);
  must(!none, line);
}

/** Markup in a run's files is text in the page, and a half line is a warning. */
async function checkHostile(browser, url) {
  const { page } = await open(browser, url, WINDOWS[0]);
  await timeToFront(page);
  const { front, candidates } = await page.evaluate(async () => (await fetch("api/run")).json());
  for (const id of [...front.slice(0, 3), ...candidates.filter(({ flags }) => flags.includes("<")).slice(0, 3).map((one) => one.id)]) {
    await page.evaluate((one) => (location.hash = encodeURIComponent(one)), id);
    await sleep(300);
  }
  const found = await page.evaluate((markup) => ({
    elements: document.querySelectorAll("img, iframe, object, embed, body script, [onerror]").length,
    harm: window.harm,
    asText: document.body.innerText.includes(markup),
    name: document.querySelector("#run-name").textContent,
    warnings: document.querySelectorAll("#warnings li").length,
  }), MARKUP);
  must(found.harm === undefined, "a script from the run's files ran");
  must(found.elements === 0, `${found.elements} elements were made from the run's files`);
  must(found.asText, "the markup is not shown as text: this check saw nothing of it");
  must(found.warnings > 0, "the half line of candidates.jsonl is not warned of");
}

async function main() {
  const [hostile, folder, pictures] = [process.argv[2] === "hostile", ...process.argv.slice(3)];
  const program = process.env.PNEUMORPH;
  if (pictures) mkdirSync(pictures, { recursive: true });
  const copy = hostile ? hostileCopy(folder) : null;
  let [server, browser] = [null, null];
  try {
    server = await serve(program, copy?.copy ?? folder);
    browser = await launch();
    if (hostile) {
      await checkHostile(browser, server.url);
      console.log("check_page: markup in the run's files stayed text");
    } else {
      const load = await checkPage(browser, server.url, pictures);
      console.log(`check_page: all is well; the front was drawn within ${load.toFixed(0)} ms`);
    }
  } finally {
    await browser?.close();
    await server?.stop();
    if (copy) rmSync(copy.parent, { recursive: true });
  }
}

main().catch((error) => {
  console.error(`check_page: ${error.message.split("\n")[0]}`);
  process.exitCode = 1;
});
