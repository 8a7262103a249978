"use strict";

// Copies into the extension what the repository keeps elsewhere: the grammar and the license.

const fs = require("node:fs");
const path = require("node:path");

for (const [from, to] of [
  ["../stl.tmLanguage.json", "stl.tmLanguage.json"],
  ["../../LICENSE", "LICENSE"],
]) {
  fs.copyFileSync(path.join(__dirname, from), path.join(__dirname, to));
}
