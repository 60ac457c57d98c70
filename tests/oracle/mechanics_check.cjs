// The page's formulas on the cases of a JSON file: [{profile, length, angle}]. Arguments: mechanics.js, the file.
"use strict";
const fs = require("fs");
const [source, cases] = process.argv.slice(2).map((file) => fs.readFileSync(file, "utf8"));
const { assess, requiredLength, springback } = new Function(`"use strict";${source}
return { assess, requiredLength, springback };`)();
const found = JSON.parse(cases).map(({ profile, length, angle }) => ({
  ...assess(profile, length, angle),
  required: requiredLength(profile, angle),
  springback: springback(profile, length, angle),
}));
process.stdout.write(`${JSON.stringify(found)}\n`);
