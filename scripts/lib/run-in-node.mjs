// Calls all functions of a WebAssembly module whose names begin with `check`: node run-in-node.mjs MODULE.
// Each returns 0, or the line of the expectation that failed.
import { readFileSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]));
const checks = Object.entries(instance.exports).filter(([name]) => name.startsWith("check"));
for (const [name, check] of checks) {
    const line = check();
    console.log(`${name}: ${line === 0 ? "passed" : `the expectation in line ${line} failed`}`);
    if (line !== 0) process.exitCode = 1;
}
if (checks.length === 0) {
    console.log("the module exports no function that begins with 'check'");
    process.exitCode = 1;
}
