// Bundles the bench to plain JavaScript and runs it: npm run bench [-- NAME…]
import { spawnSync } from "node:child_process";
import { rmSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";

const out = join("node_modules", `.bench-${process.pid}.mjs`);
try {
  await build({
    entryPoints: ["bench/bench.ts"],
    outfile: out,
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node20",
    packages: "external",
    logLevel: "error",
  });
  const run = spawnSync(process.execPath, [out, ...process.argv.slice(2)], { stdio: "inherit" });
  process.exitCode = run.status ?? 1;
} finally {
  rmSync(out, { force: true });
}
