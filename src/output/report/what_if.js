// What if the ligament, the sheet or the material were another: strain, class, torque and life of all hinges anew.

const AS_MADE = DATA.mechanics;

function buildWhatIf() {
  const form = byId("wishes");
  const material = byId("wish-material");
  DATA.materials.forEach((one, index) => material.append(element("option", { value: index }, one.name)));
  const defaults = () => {
    byId("wish-width").value = AS_MADE.width;
    byId("wish-thickness").value = AS_MADE.thickness;
    byId("wish-length").value = AS_MADE.lengths[0];
    byId("wish-length-kind").value = "drawn";
    material.value = 0;
    change();
  };
  const change = () => {
    byId("wish-length").disabled = byId("wish-length-kind").value !== "same";
    apply();
  };
  form.addEventListener("input", change);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(defaults, 0));
  defaults();
}

// The profile that the form asks for; null while a number is missing or out of range.
function wished() {
  const number = (id) => {
    const field = byId(id);
    return field.value !== "" && field.validity.valid ? field.valueAsNumber : null;
  };
  const [width, thickness, length] = ["wish-width", "wish-thickness", "wish-length"].map(number);
  const kind = byId("wish-length-kind").value;
  if (width === null || thickness === null || (kind === "same" && length === null)) return null;
  const profile = { ...AS_MADE, width, thickness, material: DATA.materials[Number(byId("wish-material").value)] };
  return { profile, kind, length };
}

function apply() {
  const wish = wished();
  if (!wish) {
    byId("wish-note").textContent = "Give every field a number above 0.";
    return;
  }
  const { profile, kind, length } = wish;
  const same = kind === "drawn" && profile.width === AS_MADE.width && profile.thickness === AS_MADE.thickness &&
    profile.material === DATA.materials[0];
  [shown.mechanics, shown.material] = [profile, profile.material];
  let short = 0;
  const loads = { strain: [], class: [], torque: [], length: [], fatigue: [] };
  for (let id = 0; id < COUNT; id += 1) {
    const angle = radians(HINGES.angle[id]);
    let free = HINGES.length[id];
    if (kind === "same") free = length;
    if (kind === "needed") {
      const needed = requiredLength(profile, angle);
      free = needed.length;
      short += needed.enough ? 0 : 1;
    }
    const load = assess(profile, free, angle);
    loads.length.push(free);
    for (const key of ["strain", "class", "torque", "fatigue"]) loads[key].push(load[key]);
  }
  showLoads(same ? loadsAsMade() : loads, !same);
  fillOutcome(loads, profile.material, short, same);
}

function outcomeRows(loads, material) {
  const classes = CLASSES.map((_, index) => loads.class.filter((one) => one === index).length);
  const torques = loads.torque.filter((torque) => torque !== null);
  const above = loads.strain.filter((strain) => strain > material.strainLimit * (1 + 1e-6)).length;
  const [least, most] = extremes(loads.strain);
  return [
    ["strain", COUNT ? `${percent(least)} to ${percent(most)}` : "\u2013"],
    [`above the limit of its material`, String(above)],
    ...CLASSES.map((name, index) => [name, String(classes[index])]),
    ["largest torque, elastic hinges", torques.length ? `${digits(extremes(torques)[1])} N mm` : "none is elastic"],
    ["torque of all elastic hinges together", torques.length ? `${digits(torques.reduce((sum, one) => sum + one, 0))} N mm` : "\u2013"],
    ["length", COUNT ? extremes(loads.length).map((value) => fixed(value, 2)).join(" to ") + " mm" : "\u2013"],
  ];
}

function fillOutcome(loads, material, short, same) {
  const made = outcomeRows(loadsAsMade(), DATA.materials[0]);
  const wish = outcomeRows(loads, material);
  byId("outcome").tBodies[0].replaceChildren(...made.map(([name, value], i) =>
    element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value), element("td", {}, same ? "" : wish[i][1]))));
  const beyond = short > 0 ? ` ${short} hinges would need a longer ligament than the profile allows.` : "";
  byId("wish-note").textContent = same ? "" : `Sheet, table and spread show these values now.${beyond}`;
}
