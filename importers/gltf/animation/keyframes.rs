//! Values over time: step, linear, and cubic splines (specification, appendix C).

use ajar_scene::Diagnostic;
use glam::DQuat;

use super::{
    super::{Asset, Context, accessor::Accessor},
    Sampler,
};

/// Bytes that a number costs on its way into the JSON.
const NUMBER: u64 = 64;

#[derive(Clone, Copy, PartialEq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// A sampler whose accessors fit each other.
pub(super) struct Keyframes<'a> {
    /// Seconds, increasing; at least one.
    times: Vec<f64>,
    values: Accessor<'a>,
    interpolation: Interpolation,
    /// Numbers of one value.
    width: usize,
}

impl<'a> Keyframes<'a> {
    /// # Errors
    /// An accessor is broken, times do not increase, or there are not as many values as times.
    pub fn open(
        asset: &'a Asset,
        context: &mut Context,
        sampler: &Sampler,
        element: &str,
    ) -> Result<Self, Diagnostic> {
        let input = format!("{element}.input");
        let error =
            |field: &str, why: &str| Err(Diagnostic::error(why).element(format!("{element}.{field}")));
        let interpolation = match sampler.interpolation.as_deref() {
            Some("STEP") => Interpolation::Step,
            Some("LINEAR") | None => Interpolation::Linear,
            Some("CUBICSPLINE") => Interpolation::Cubic,
            Some(_) => return error("interpolation", "unknown interpolation"),
        };
        let keys = Accessor::open(asset, context, sampler.input as usize, &[1], &input)?;
        context.charge(u64::from(keys.count) * 8, &input)?;
        let times: Vec<_> = (0..keys.count).map(|i| f64::from(keys.get::<1>(i, 0.0)[0])).collect();
        if !times.is_sorted_by(|a, b| a < b) || times.iter().any(|time| !time.is_finite()) {
            return error("input", "the times do not increase");
        }
        let output = format!("{element}.output");
        let values = Accessor::open(asset, context, sampler.output as usize, &[1, 2, 3, 4], &output)?;
        let parts = if interpolation == Interpolation::Cubic { 3 } else { 1 };
        let elements = values.count as usize / (times.len() * parts);
        if elements == 0 || elements * parts * times.len() != values.count as usize {
            return error("output", "there are not as many values as times");
        }
        let width = elements * values.width;
        context.charge(width as u64 * NUMBER, &output)?;
        Ok(Self { times, values, interpolation, width })
    }

    /// The value at a time; before the first and after the last it stays what it is there.
    pub fn at(&self, seconds: f64, is_rotation: bool) -> Vec<f64> {
        let after = self.times.partition_point(|&time| time <= seconds);
        let before = after.saturating_sub(1);
        let (Some(&start), Some(&end)) = (self.times.get(before), self.times.get(after)) else {
            return self.value(before);
        };
        if after == 0 || self.interpolation == Interpolation::Step {
            return self.value(before);
        }
        let (length, x) = (end - start, (seconds - start) / (end - start));
        let (from, to) = (self.value(before), self.value(after));
        match self.interpolation {
            Interpolation::Cubic => {
                let (leaving, arriving) = (self.part(before, 2), self.part(after, 0));
                let spline = (0..self.width).map(|i| {
                    let ends = [from[i], to[i]];
                    hermite(ends, [leaving[i] * length, arriving[i] * length], x)
                });
                let value: Vec<_> = spline.collect();
                if is_rotation { normalized(&value) } else { value }
            }
            _ if is_rotation => slerp(&from, &to, x),
            _ => from.iter().zip(&to).map(|(a, b)| a + (b - a) * x).collect(),
        }
    }

    fn value(&self, key: usize) -> Vec<f64> {
        self.part(key, usize::from(self.interpolation == Interpolation::Cubic))
    }

    /// A value, or with splines the incoming tangent (0), the value (1) or the outgoing tangent (2).
    fn part(&self, key: usize, part: usize) -> Vec<f64> {
        let parts = if self.interpolation == Interpolation::Cubic { 3 } else { 1 };
        let first = (key * parts + part) * self.width;
        let number = |i: usize| {
            let element = self.values.get::<4>((i / self.values.width) as u32, 0.0);
            f64::from(element[i % self.values.width])
        };
        (first..first + self.width).map(number).collect()
    }
}

fn hermite(ends: [f64; 2], tangents: [f64; 2], x: f64) -> f64 {
    let (x2, x3) = (x * x, x * x * x);
    (2.0 * x3 - 3.0 * x2 + 1.0) * ends[0]
        + (x3 - 2.0 * x2 + x) * tangents[0]
        + (3.0 * x2 - 2.0 * x3) * ends[1]
        + (x3 - x2) * tangents[1]
}

/// A quaternion out of four numbers; what is none becomes NaN, which the caller finds.
fn quaternion(value: &[f64]) -> DQuat {
    <[f64; 4]>::try_from(value).map_or(DQuat::NAN, |q| DQuat::from_array(q).normalize())
}

fn normalized(value: &[f64]) -> Vec<f64> {
    quaternion(value).to_array().to_vec()
}

fn slerp(from: &[f64], to: &[f64], x: f64) -> Vec<f64> {
    quaternion(from).slerp(quaternion(to), x).to_array().to_vec()
}
