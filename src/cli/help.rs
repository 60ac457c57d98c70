//! Examples at the end of each command's help, man page and page in `docs/commands`. A test runs them in the repository's
//! folder, after those of `README.md`.

pub const MAIN: &str = "\
Exit status: 0 made; 1 bad input, profile or usage; 2 not makeable, target not reached, interrupted, a hinge or a cut \
file that fails. Ctrl-C stops at the next step and leaves design.partial.json in the results' folder, from which \
--resume goes on; a second Ctrl-C stops at once (130).

Colours are left out where the output is no terminal or NO_COLOR is set.

Examples:
  kirimorph make samples/dome.toml
  kirimorph verify out/dome";

pub const MAKE: &str = "\
Examples:
  kirimorph make samples/dome.toml
  kirimorph make samples/closing.toml -o out/vault --quiet";

pub const DESIGN: &str = "\
Examples:
  kirimorph design samples/dome.toml --feasibility-only --map out/dome-map.svg
  kirimorph design samples/dome.toml -o out/dome.design.json --quiet";

pub const CHECK: &str = "\
Examples:
  kirimorph check out/dome --profile steel-304-0.5mm --worst 5";

pub const FABRICATE: &str = "\
Examples:
  kirimorph fabricate out/dome --profile steel-304-0.5mm -o out/four-tabs --tabs 4 --leads arc";

pub const VERIFY: &str = "\
Examples:
  kirimorph verify out/dome";

pub const IMPORT: &str = "\
Examples:
  kirimorph import --closed samples/import/dome-closed.obj --open samples/import/dome-open.obj --improve \
--profile steel-304-0.5mm -o out/imported.json";

pub const EXPORT: &str = "\
Examples:
  kirimorph export out/dome --obj-pair out/dome-pair
  kirimorph export out/dome --stl out/dome-pieces --thickness-mm 0.5 --state open
  kirimorph export out/dome --format glb,obj,stl --thickness-mm 0.5 -o out/dome-export";

pub const SNAP: &str = "\
Examples:
  kirimorph make samples/snap-flat.toml
  kirimorph snap out/snap-flat --profile nylon-6-5mm -o out/snap.json --plot out/snap.svg";

pub const COUPON: &str = "\
Examples:
  kirimorph coupon --profile steel-304-0.5mm";

pub const PROFILES: &str = "\
Examples:
  kirimorph profiles
  kirimorph profiles steel-304-0.5mm > my-steel.toml";

pub const MACHINES: &str = "\
Examples:
  kirimorph machines
  kirimorph machines linuxcnc-xyzbc-trt > my-mill.toml";

pub const NEW: &str = "\
Examples:
  kirimorph new samples/dome.obj -o my-dome.toml
  kirimorph new samples/dome.obj -o small.toml --size-mm 200";

pub const COMPLETIONS: &str = "\
Examples:
  kirimorph completions bash > kirimorph.bash
  kirimorph completions zsh > _kirimorph";

pub const MAN: &str = "\
Examples:
  kirimorph man -o out/man";
