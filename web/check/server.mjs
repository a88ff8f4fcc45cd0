// The program that serves the page, as a child process.
import { spawn } from "node:child_process";

/** Milliseconds until it must have said where it listens. */
const PATIENCE = 20000;

/** Starts `program monitor folder --port 0`; gives its address and a function that ends it. */
export function serve(program, folder) {
  const child = spawn(program, ["monitor", folder, "--port", "0"], { stdio: ["ignore", "pipe", "pipe"] });
  const stop = () => new Promise((done) => {
    if (child.exitCode !== null || child.signalCode !== null) return done();
    child.once("exit", done);
    child.kill();
    return undefined;
  });
  return new Promise((resolve, reject) => {
    let [said, complained] = ["", ""];
    const fail = (why) => {
      clearTimeout(timer);
      reject(new Error(`${program} monitor: ${why}`));
    };
    const timer = setTimeout(() => {
      child.kill();
      fail("no address within 20 s");
    }, PATIENCE);
    child.stderr.on("data", (text) => (complained += text));
    child.stdout.on("data", (text) => {
      said += text;
      const [url] = /http:\/\/127\.0\.0\.1:\d+\//.exec(said) ?? [];
      if (!url) return;
      clearTimeout(timer);
      resolve({ url, stop });
    });
    child.on("error", (error) => fail(error.message));
    child.on("exit", (code) => fail(`ended with ${code} before it served: ${complained.trim()}`));
  });
}
