// Bundles the page: node bundle.mjs FOLDER writes index.html, viewer.js and viewer.css there.
import { copyFileSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";

const folder = process.argv[2];
if (!folder) {
  console.error("usage: node bundle.mjs FOLDER");
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
await build({
  entryPoints: { viewer: "src/main.ts" },
  outdir: folder,
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  // Text outside ASCII would depend on how a file that someone saves is read back.
  charset: "ascii",
  legalComments: "inline",
  logLevel: "error",
});
await build({
  entryPoints: { viewer: "src/style.css" },
  outdir: folder,
  minify: true,
  charset: "ascii",
  logLevel: "error",
});
copyFileSync("src/index.html", join(folder, "index.html"));
