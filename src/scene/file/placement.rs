//! Where things are: the keys `translate`, `rotate`, `scale`, `up`, `unit`, `position`, `target`, `direction`.

use glam::{DAffine3, DMat3, DVec3};
use toml::de::DeValue;

use super::{
    keys::Keys,
    report::Complaint,
    value::{POSITIVE, choice, number, numbers, vector},
};
use crate::bounds::looking;

/// The transform of an imported file: its up axis is turned to +Y, its units become metres, then it is scaled, rotated
/// and moved.
pub(super) fn import(keys: &mut Keys<'_>) -> DAffine3 {
    // A quarter turn about X, exact: +Z becomes +Y.
    let z_up = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    let up = keys.optional("up", choice([("y", DMat3::IDENTITY), ("z", z_up)])).unwrap_or(DMat3::IDENTITY);
    let unit = keys.optional("unit", number(POSITIVE)).unwrap_or(1.0);
    let scale = keys.optional("scale", scale).unwrap_or(DVec3::ONE);
    let rotate = keys.optional("rotate", vector).map_or(DMat3::IDENTITY, rotation);
    let translate = keys.optional("translate", vector).unwrap_or(DVec3::ZERO);
    DAffine3::from_mat3_translation(rotate * DMat3::from_diagonal(scale * unit) * up, translate)
}

/// One factor or three, none of them zero.
pub(super) fn scale(value: &DeValue<'_>) -> Result<DVec3, Complaint> {
    let scale = match value {
        DeValue::Array(_) => vector(value)?,
        _ => DVec3::splat(number(super::value::ANY)(value)?),
    };
    if scale.cmpne(DVec3::ZERO).all() { Ok(scale) } else { Err(Complaint::new("must not be zero")) }
}

/// Degrees about X, then Y, then Z of the parent's space. Whole quarter turns are exact.
pub(super) fn rotation(degrees: DVec3) -> DMat3 {
    let turn = |degrees: f64| {
        let quarters = degrees / 90.0;
        if quarters.fract() == 0.0 {
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters.rem_euclid(4.0) as usize % 4]
        } else {
            degrees.to_radians().sin_cos()
        }
    };
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.to_array().map(turn);
    let x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
    let y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
    let z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
    z * y * x
}

/// Position and target of a camera: its transform, and the distance of the target where there is one. What is not said is
/// as in `base`.
pub(super) fn camera(keys: &mut Keys<'_>, base: DAffine3) -> (DAffine3, Option<f64>) {
    let position = keys.optional("position", vector).unwrap_or(base.translation);
    let target = keys.optional("target", vector);
    let up = keys.optional("up", vector);
    let forward = target.map_or(-base.matrix3.z_axis, |target| target - position);
    if forward == DVec3::ZERO {
        keys.complain("target", Complaint::new("must differ from the position"));
    }
    if let Some(up) = up
        && up.cross(forward).length() <= 1e-9 * up.length() * forward.length()
        && forward != DVec3::ZERO
    {
        keys.complain("up", Complaint::new("must not lie along the line of sight"));
    }
    let transform = if target.is_none() && up.is_none() {
        DAffine3::from_mat3_translation(base.matrix3, position)
    } else {
        looking(position, forward, up.unwrap_or(DVec3::Y))
    };
    (transform, target.map(|target| target.distance(position)))
}

/// Position and aim of a light: −Z along `direction`, towards `target`, or turned by `rotate`.
pub(super) fn aimed(keys: &mut Keys<'_>) -> DAffine3 {
    let ways = ["target", "direction", "rotate"];
    let said: Vec<_> = ways.into_iter().filter(|key| keys.has(key)).collect();
    if let [first, second, ..] = said[..] {
        keys.complain(second, Complaint::new(format!("cannot go with \"{first}\"")));
    }
    let position = keys.optional("position", vector).unwrap_or(DVec3::ZERO);
    let target = keys.optional("target", vector).map(|target| ("target", target - position));
    let direction = keys.optional("direction", vector).map(|direction| ("direction", direction));
    let rotate = keys.optional("rotate", vector);
    match (target.or(direction), rotate) {
        (Some((key, forward)), _) if forward == DVec3::ZERO => {
            let why = if key == "target" { "must differ from the position" } else { "must not be zero" };
            keys.complain(key, Complaint::new(why));
            DAffine3::IDENTITY
        }
        (Some((_, forward)), _) => looking(position, forward, DVec3::Y),
        (None, Some(degrees)) => DAffine3::from_mat3_translation(rotation(degrees), position),
        (None, None) => DAffine3::from_translation(position),
    }
}

/// Position and rotation of a thing without direction to aim.
pub(super) fn turned(keys: &mut Keys<'_>) -> DAffine3 {
    let position = positioned(keys).translation;
    let rotate = keys.optional("rotate", vector).map_or(DMat3::IDENTITY, rotation);
    DAffine3::from_mat3_translation(rotate, position)
}

/// Position alone.
pub(super) fn positioned(keys: &mut Keys<'_>) -> DAffine3 {
    DAffine3::from_translation(keys.optional("position", vector).unwrap_or(DVec3::ZERO))
}

/// Two finite numbers as the scene keeps them.
pub(super) fn pair(value: &DeValue<'_>) -> Result<[f32; 2], Complaint> {
    numbers::<2>(super::value::ANY)(value).map(|pair| pair.map(|number| number as f32))
}
