// The hinge as a bent beam: the formulas of src/fabrication/mechanics.rs and notch.rs, which a test compares.
// `p`: { width, thickness, kerf, shape, rootCompliance, lengths: [least, largest], material: {...} }, millimetres, MPa;
// angles are radians, strains plain ratios.

const CLASSES = ["elastic", "plastic low-cycle", "beyond elongation"];

// A groove's round end beside a straight wall: the straight beam's length that is as stiff (Simpson's rule).
function notchLength(radius, width) {
  const steps = 200;
  const step = Math.PI / steps;
  let sum = 0;
  for (let i = 1; i < steps; i += 1) {
    const cos = Math.sin(i * step);
    sum += ((i % 2 === 1 ? 4 : 2) * radius * cos) / (1 + (radius / width) * (1 - cos)) ** 3;
  }
  return (sum * step) / 3;
}

function plasticLength(p, free) {
  return p.shape === "notch" ? free - p.kerf + notchLength(0.5 * p.kerf, p.width) : free;
}

function elasticLength(p, free) {
  return p.shape === "notch" ? plasticLength(p, free) : free + p.rootCompliance * p.width;
}

function nominalStrain(p, effective, angle) {
  return (p.width * angle) / (2 * effective);
}

function stiffness(p, effective) {
  return (p.material.youngsModulus * p.thickness * p.width ** 3) / (12 * effective);
}

// How far a yielded hinge turns back when let go, radians: a rectangular section that yields without hardening, bent to
// curvature c, gives back 1.5 c_y (1 - (c_y / c)^2 / 3), c_y being that of first yield.
function springback(p, free, angle) {
  const first = (2 * elasticLength(p, free) * p.material.yieldStrain) / p.width;
  return angle <= first ? angle : 1.5 * first * (1 - (first / angle) ** 2 / 3);
}

function fatigueWords(material, strain) {
  const amplitude = strain / 2;
  if (strain > material.elongation) return "tears";
  if (material.enduranceStrain !== null && amplitude <= material.enduranceStrain) return "unlimited";
  if (material.coffinManson === null) return "unknown";
  const [coefficient, exponent] = material.coffinManson;
  const cycles = (amplitude / coefficient) ** (1 / exponent) / 2;
  if (cycles === Infinity) return "unlimited";
  if (cycles < 10) return "single deployment";
  const decade = 10 ** Math.floor(Math.log10(cycles));
  return `about ${Math.round(cycles / decade) * decade} cycles (order of magnitude)`;
}

// Strain, class (index into CLASSES), torque (null above yield) and life of a ligament at the full angle.
function assess(p, free, angle) {
  const material = p.material;
  const elastic = elasticLength(p, free);
  const elasticStrain = nominalStrain(p, elastic, angle);
  if (elasticStrain <= material.yieldStrain) {
    const torque = stiffness(p, elastic) * angle;
    return { effective: elastic, strain: elasticStrain, class: 0, torque, fatigue: fatigueWords(material, elasticStrain) };
  }
  const effective = plasticLength(p, free);
  const strain = nominalStrain(p, effective, angle);
  const tears = strain > material.elongation;
  return { effective, strain, class: tears ? 2 : 1, torque: null, fatigue: fatigueWords(material, strain) };
}

// The least free length that an angle asks for, and whether the profile's longest ligament is long enough.
function requiredLength(p, angle) {
  const [shortest, longest] = p.lengths;
  const byStrain = (p.width * angle) / (2 * p.material.strainLimit) - plasticLength(p, 0);
  const least = Math.max(byStrain, p.width * Math.tan(angle / 2), shortest);
  const needed = least > shortest ? Math.ceil(least * 100 - 1e-8) / 100 : shortest;
  return { length: Math.min(needed, longest), enough: needed <= longest };
}
