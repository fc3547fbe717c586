//! The density sweep: how likely each bidirectional technique was to build a path (Veach 1997 §10.2).
//!
//! Technique `s` builds `s` vertices from the light and the rest from the eye. All ratios of densities follow from the
//! densities of the single steps:
//!
//! ```text
//! p_1 / p_0     = P_L / p⃖_1
//! p_{s+1} / p_s = p⃗_{s-1} / p⃖_{s+1}          s ≥ 1
//! ```

/// A complete path as the sweep sees it; slices have an entry for each of the k+1 vertices.
#[derive(Clone, Copy, Debug)]
pub struct Densities<'a> {
    /// `to_eye[i]`: density of x_{i+1} given x_i, roulette included.
    pub to_eye: &'a [f64],
    /// `to_light[i]`: density of x_{i-1} given x_i, roulette included.
    pub to_light: &'a [f64],
    /// Whether a connection may end at the vertex.
    pub connectable: &'a [bool],
    /// Density P_L of x_0 as a sampled light end.
    pub light: f64,
    /// Whether eye paths can meet x_0.
    pub light_can_be_hit: bool,
    /// Light paths per eye path over the whole film: weighs technique t = 1.
    pub light_fraction: f64,
}

impl Densities<'_> {
    /// Number of edges.
    pub fn edges(&self) -> usize {
        self.connectable.len() - 1
    }

    /// Whether technique `s` can build the path: its connecting edge must not touch a Dirac event.
    pub fn possible(&self, s: usize) -> bool {
        let connects = |i: usize| self.connectable[i];
        match s {
            0 => self.light_can_be_hit,
            _ if s > self.edges() => false,
            _ => connects(s - 1) && connects(s),
        }
    }

    /// Calls `visit(s, p_s / p_r)` for every possible technique, `reference` = r among them. The reference must be one
    /// that really built the path: then no divisor is 0.
    pub fn for_each_ratio(&self, reference: usize, mut visit: impl FnMut(usize, f64)) {
        let k = self.edges();
        let weigh = |s: usize| if s == k && k > 1 { self.light_fraction } else { 1.0 };
        let mut emit = |s: usize, ratio: f64| {
            if self.possible(s) {
                visit(s, ratio * weigh(s) / weigh(reference));
            }
        };
        emit(reference, 1.0);
        let mut ratio = 1.0;
        for s in reference + 1..=k {
            ratio *= self.generated_by_light(s) / self.to_light[s];
            emit(s, ratio);
        }
        ratio = 1.0;
        for s in (0..reference).rev() {
            ratio *= self.to_light[s + 1] / self.generated_by_light(s + 1);
            emit(s, ratio);
        }
    }

    /// Density by which technique `s` makes its last light vertex, x_{s-1}.
    fn generated_by_light(&self, s: usize) -> f64 {
        if s == 1 { self.light } else { self.to_eye[s - 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TO_EYE: [f64; 5] = [0.3, 2.0, 0.7, 1.1, 0.0];
    const TO_LIGHT: [f64; 5] = [0.0, 0.9, 0.2, 3.0, 1.5];

    fn densities(connectable: &[bool; 5]) -> Densities<'_> {
        Densities {
            to_eye: &TO_EYE,
            to_light: &TO_LIGHT,
            connectable,
            light: 0.4,
            light_can_be_hit: true,
            light_fraction: 0.25,
        }
    }

    /// p_s by its definition: light steps from the left, eye steps from the right.
    fn density(s: usize) -> f64 {
        let light = if s == 0 { 1.0 } else { 0.4 * TO_EYE[..s - 1].iter().product::<f64>() };
        let share = if s == 4 { 0.25 } else { 1.0 };
        light * TO_LIGHT[s + 1..].iter().product::<f64>() * share
    }

    #[test]
    fn ratios_are_those_of_the_products() {
        let all = [true; 5];
        for reference in 0..=4 {
            let mut count = 0;
            densities(&all).for_each_ratio(reference, |s, ratio| {
                count += 1;
                assert!((ratio - density(s) / density(reference)).abs() < 1e-12, "{reference} {s}");
            });
            assert_eq!(count, 5);
        }
    }

    /// By the balance heuristic.
    fn weight(d: &Densities<'_>, s: usize) -> f64 {
        let mut sum = 0.0;
        d.for_each_ratio(s, |_, ratio| sum += ratio);
        1.0 / sum
    }

    #[test]
    fn weights_sum_to_one() {
        for connectable in [[true; 5], [true, false, true, true, true], [true, true, false, true, true]] {
            let d = densities(&connectable);
            let sum: f64 = (0..=4).filter(|&s| d.possible(s)).map(|s| weight(&d, s)).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
