// Asks the server, and polls it for the run.

const EVERY = 2000;
const EVERY_WHEN_HIDDEN = 20000;
const EVERY_WHEN_FINISHED = 10000;
const PATIENCE = 15000;

/** The answer of `api/<path>`; throws an `Error` with the server's own line when it refuses. */
export async function ask(path, signal) {
  const response = await fetch(`api/${path}`, { signal, cache: "no-store" });
  if (response.ok) return response.json();
  throw new Error(await reasonOf(response));
}

async function reasonOf(response) {
  try {
    const { error } = await response.json();
    if (typeof error === "string") return error;
  } catch {
    // An answer that is not JSON has no line of its own.
  }
  return `the server answered ${response.status} ${response.statusText}`.trim();
}

/**
 * Calls `onRun(run)` whenever `api/run` has changed, and `onContact(error)` after each question, with
 * `null` where there was an answer. Asks less often while the page is hidden or the run is over.
 */
export function poll(onRun, onContact) {
  let tag = null;
  let state = "running";
  let timer = 0;

  async function once() {
    clearTimeout(timer);
    try {
      const response = await fetch("api/run", {
        cache: "no-store",
        headers: tag ? { "If-None-Match": tag } : {},
        signal: AbortSignal.timeout(PATIENCE),
      });
      if (response.ok) {
        const run = await response.json();
        tag = response.headers.get("ETag");
        state = run.state;
        onRun(run);
      } else if (response.status !== 304) {
        throw new Error(await reasonOf(response));
      }
      onContact(null);
    } catch (error) {
      onContact(error);
    }
    clearTimeout(timer);
    timer = setTimeout(once, pause());
  }

  function pause() {
    if (document.hidden) return EVERY_WHEN_HIDDEN;
    return state === "finished" ? EVERY_WHEN_FINISHED : EVERY;
  }

  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) once();
  });
  return once();
}
