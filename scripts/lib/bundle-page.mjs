// Joins the files of the page in one file, page.html, into which `mariana page` writes a song: node bundle-page.mjs FOLDER.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const folder = process.argv[2];
const read = (name) => readFileSync(join(folder, name), "utf8");
const module = gzipSync(readFileSync(join(folder, "mariana_page_bg.wasm")), { level: 9 }).toString("base64");
let page = read("index.html");
const replace = (tag, text) => {
    if (!page.includes(tag)) throw new Error(`index.html lacks ${tag}`);
    // A function, because a text may contain signs that `replace` would read.
    page = page.replace(tag, () => text);
};
replace('<link rel="stylesheet" href="style.css">', `<style>\n${read("style.css")}</style>`);
replace('<script id="module" type="text/plain"></script>', `<script id="module" type="text/plain">${module}</script>`);
for (const name of ["mariana_page.js", "studio.js"]) replace(`<script src="${name}"></script>`, `<script>\n${read(name)}</script>`);
writeFileSync(join(folder, "page.html"), page);
