// A run whose words are markup, and whose candidates end in the middle of a line.
import { cpSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

/** Runs when it becomes an element instead of text. No slash: it is a folder's name too. */
export const MARKUP = "<img src=x onerror=window.harm=1>";

/** Copies `folder` into a temporary one, named and filled with markup; gives both paths. */
export function hostileCopy(folder) {
  const parent = mkdtempSync(join(tmpdir(), "pneumorph-hostile-"));
  const copy = join(parent, MARKUP);
  cpSync(folder, copy, { recursive: true });

  const path = join(copy, "candidates.jsonl");
  const lines = readFileSync(path, "utf8").trim().split("\n").map(spoil);
  const last = lines.at(-1);
  writeFileSync(path, [...lines.slice(0, -1), last.slice(0, last.length / 2)].join("\n"));

  const provenance = join(copy, "provenance.json");
  const made = JSON.parse(readFileSync(provenance, "utf8"));
  writeFileSync(provenance, JSON.stringify({ ...made, commit: MARKUP }));
  return { parent, copy };
}

/** Markup in the words of every seventh candidate; a few get words that the program never writes. */
function spoil(line, k) {
  if (k % 7 !== 0) return line;
  const candidate = JSON.parse(line);
  if (candidate.status === "rejected") {
    return JSON.stringify({ ...candidate, reason: MARKUP, detail: `${MARKUP}<script>window.harm=1</script>` });
  }
  if (k % 21 === 0) return JSON.stringify({ ...candidate, exploits: [MARKUP] });
  return JSON.stringify({ ...candidate, bending_ending: MARKUP, blocking_ending: MARKUP });
}
