// Makes the bundles: `npm run build`. The same sources give the same bytes. Each bundle begins with
// the licenses of the packages in it, and with its sources and their hash, by which a test sees
// without node that a bundle is stale.

import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const ROOT = dirname(fileURLToPath(import.meta.url));
const FOLDER = process.argv[2] ?? join(ROOT, "bundle");

// What each bundle is made from. Scripts are plain ones, except for the viewer, which is a module.
const BUNDLES = {
  "report.css": "src/report.css",
  "report.js": "src/report.ts",
  "solid.js": "src/solid.ts",
  "designer.css": "src/designer/designer.css",
  "designer.js": "src/designer/main.ts",
  "viewer.js": "src/viewer.ts",
};

// Names under which other scripts find what a plain script exports.
const GLOBALS = { "solid.js": "camgeoSolid" };

const ALSO = ["build.mjs", "package.json", "package-lock.json", "tsconfig.json"]; // that bundles depend on

const sha256 = (data) => createHash("sha256").update(data).digest("hex");

function packageOf(path) {
  const [, scope, name] = /^node_modules\/(@[^/]+\/)?([^/]+)\//.exec(path);
  return `${scope ?? ""}${name}`;
}

function license(name) {
  const folder = join(ROOT, "node_modules", name);
  const { version, license: terms } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const file = ["LICENSE", "LICENSE.md", "LICENSE.txt"].map((each) => join(folder, each)).find(existsSync);
  if (!file) throw new Error(`${name} has no text of its license`);
  return `${name} ${version} (${terms})\n\n${readFileSync(file, "utf8").trim()}`;
}

for (const [name, entry] of Object.entries(BUNDLES)) {
  if (!existsSync(join(ROOT, entry))) continue;
  const { outputFiles, metafile } = await build({
    absWorkingDir: ROOT,
    entryPoints: [entry],
    bundle: true,
    write: false,
    metafile: true,
    minify: true,
    charset: "utf8",
    format: name === "viewer.js" ? "esm" : "iife",
    globalName: GLOBALS[name],
    target: "es2022",
    loader: name.endsWith(".js") ? { ".css": "text" } : {},
    legalComments: "none", // the header has the licenses whole
  });
  const inputs = Object.keys(metafile.inputs);
  const foreign = inputs.filter((path) => path.startsWith("node_modules/"));
  const own = [...inputs.filter((path) => !path.startsWith("node_modules/")), ...ALSO].sort();
  const body = outputFiles[0].text;
  const header = [
    "/* Made by build.mjs from:",
    ...own,
    `sources ${sha256(own.map((path) => `${path} ${sha256(readFileSync(join(ROOT, path)))}\n`).join(""))}`,
    `bundle ${sha256(body)}`,
    ...[...new Set(foreign.map(packageOf))].sort().map((each) => `\nIt contains ${license(each)}`),
    "*/\n",
  ].join("\n");
  if (/\*\/|<\/script|<!--/i.test(header.slice(2, -3)) || /<\/script|<!--/i.test(body)) throw new Error(`${name} would end where it must not`);
  mkdirSync(FOLDER, { recursive: true });
  writeFileSync(join(FOLDER, name), header + body);
}
