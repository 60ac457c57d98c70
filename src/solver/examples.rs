//! Small systems of several structures, for tests.

use super::dissection::Cliques;

/// Pseudo-random numbers: a linear congruential generator with the constants of Knuth's MMIX.
pub struct Random(pub u64);

impl Random {
    /// The next number, from -1 to 1.
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The next index below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        ((0.5 + 0.5 * self.number()) * count as f64) as usize
    }
}

/// Unknowns at places, and which of them are coupled.
pub struct Structure {
    pub name: &'static str,
    pub places: Vec<[f64; 2]>,
    pub couplings: Vec<Vec<u32>>,
}

impl Structure {
    /// Its couplings in the solver's form.
    pub fn cliques(&self) -> Cliques {
        let mut cliques = Cliques::default();
        self.couplings.iter().for_each(|coupling| cliques.push(coupling.iter().copied()));
        cliques
    }
}

/// A grid of n by n points with so many unknowns each, coupled with its eight neighbours (the 9-point stencil).
pub fn grid(n: usize, per_point: usize) -> Structure {
    let point = |k: usize| [(k % n) as f64, (k / n) as f64];
    let cell = |k: usize| {
        let first = k / (n - 1) * n + k % (n - 1);
        let points = [first, first + 1, first + n, first + n + 1];
        points.iter().flat_map(|p| (0..per_point).map(move |i| (p * per_point + i) as u32)).collect()
    };
    Structure {
        name: "grid",
        places: (0..n * n * per_point).map(|u| point(u / per_point)).collect(),
        couplings: (0..(n - 1) * (n - 1)).map(cell).collect(),
    }
}

/// One coupling of all of `n` unknowns at random places.
pub fn clique(n: usize) -> Structure {
    let mut random = Random(3);
    let places = (0..n).map(|_| [random.number(), random.number()]).collect();
    Structure { name: "clique", places, couplings: vec![(0..n as u32).collect()] }
}

/// Two grids far from each other, and unknowns that nothing couples.
fn islands() -> Structure {
    let mut islands = grid(12, 2);
    let count = islands.places.len() as u32;
    islands.places.extend(grid(9, 1).places.iter().map(|[x, y]| [x + 100.0, y - 40.0]));
    islands.couplings.extend(grid(9, 1).couplings.iter().map(|c| c.iter().map(|u| u + count).collect()));
    islands.places.extend((0..70).map(|i| [50.0, f64::from(i)]));
    Structure { name: "islands", ..islands }
}

fn chain(name: &'static str, places: Vec<[f64; 2]>) -> Structure {
    let couplings = (1..places.len() as u32).map(|i| vec![i - 1, i]).collect();
    Structure { name, places, couplings }
}

/// Couplings that know nothing of the places.
fn scattered() -> Structure {
    let mut random = Random(5);
    let n = 400;
    let coupling = |random: &mut Random| {
        let mut members: Vec<u32> = (0..3).map(|_| random.index(n) as u32).collect();
        members.sort_unstable();
        members.dedup();
        members
    };
    let places = (0..n).map(|_| [random.number(), random.number()]).collect();
    let couplings = (0..300).map(|_| coupling(&mut random)).collect();
    Structure { name: "scattered", places, couplings }
}

/// One of each kind.
pub fn structures() -> Vec<Structure> {
    vec![
        grid(20, 2),
        clique(150),
        islands(),
        chain("path", (0..300).map(|i| [f64::from(i), 0.5]).collect()),
        chain("one place", vec![[1.0, 2.0]; 90]),
        scattered(),
        chain("single", vec![[0.0; 2]]),
        chain("empty", Vec::new()),
    ]
}
