// A browser without a window or a graphics card, and a page in it whose every complaint is kept.
import puppeteer from "puppeteer-core";

const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

/** Starts Chromium with a software renderer for WebGL. */
export const launch = () =>
  puppeteer.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });

/** Opens `url`; `complaints` fills with what the console, the page and its requests had to say. */
export async function open(browser, url, { width, height, scheme }) {
  const page = await browser.newPage();
  const complaints = [];
  const origin = new URL(url).origin;
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) complaints.push(`the console says: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`a script failed: ${error.message}`));
  page.on("request", (request) => {
    const target = new URL(request.url());
    if (target.origin !== origin) complaints.push(`a request left for ${target.href}`);
  });
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
  await page.goto(url, { waitUntil: "domcontentloaded" });
  return { page, complaints };
}

/** Milliseconds from the navigation until the front was drawn. */
export async function timeToFront(page) {
  await page.waitForFunction(() => performance.getEntriesByName("front-drawn").length > 0, { timeout: 20000 });
  return page.evaluate(() => performance.getEntriesByName("front-drawn")[0].startTime);
}

/** Clicks the mouse where the chart has drawn the design with this id. */
export async function clickPoint(page, id) {
  const place = await page.evaluate((one) => window.pneumorph.pixelOf(one), id);
  if (!place) throw new Error(`the chart has no place for ${id}`);
  await page.mouse.click(place.x, place.y);
}

/** The picture in three dimensions, on a grid of 96 x 72: how many colours it has, and its pixels. */
export function readPicture(page) {
  return page.evaluate(() => {
    const picture = document.querySelector("#view > canvas");
    if (!picture) return { colours: 0, pixels: [] };
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [96, 72];
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0, canvas.width, canvas.height);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let k = 0; k < data.length; k += 4) colours.add(data.slice(k, k + 4).join());
    return { colours: colours.size, pixels: [...data] };
  });
}
