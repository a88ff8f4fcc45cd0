// Numbers, shares and times as a person reads them.

/** A number with so many significant digits; a dash for what is not one. */
export function number(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return value.toExponential(digits - 1);
  return size >= 10 ** (digits - 1) ? value.toFixed(0) : String(Number(value.toPrecision(digits)));
}

/** A number and its unit. */
export const quantity = (value, unit, digits) =>
  Number.isFinite(value) ? `${number(value, digits)} ${unit}` : "–";

/** A whole number with thin spaces between thousands. */
export const count = (value) =>
  Number.isFinite(value) ? String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u2009") : "–";

/** A share in percent. */
export const percent = (share, digits = 2) =>
  Number.isFinite(share) ? `${number(100 * share, digits)}\u2009%` : "–";

/** A duration in its two largest units. */
export function duration(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds < 90) return `${Math.max(0, Math.round(seconds))} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 90) return `${minutes} min`;
  const hours = Math.floor(minutes / 60);
  if (hours < 48) return `${hours} h ${minutes % 60} min`;
  return `${Math.floor(hours / 24)} d ${hours % 24} h`;
}

/** A name of a file or a table as words: `Surface/unresolved_mesh` is "surface: unresolved mesh". */
export const words = (name) =>
  name.replace("/", ": ").replaceAll("_", " ").replace(/^[A-Z]/, (letter) => letter.toLowerCase());
