// The style sheet's colours, for what is drawn on canvases.

const dark = matchMedia("(prefers-color-scheme: dark)");

/** The colour that the style sheet names `--<name>`. */
export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** The same colour, so far transparent: 0 is invisible, 1 is solid. */
export const faint = (name, alpha) =>
  `color-mix(in srgb, ${colour(name)} ${100 * alpha}%, transparent)`;

/** Calls back when the person changes between light and dark. */
export const onSchemeChange = (redraw) => dark.addEventListener("change", redraw);
