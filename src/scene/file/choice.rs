//! Which variant and which moment of an import: the keys `variant`, `frame`, `time`, `fps`.

use toml::de::DeValue;

use super::{
    keys::Keys,
    report::Complaint,
    value::{ANY, POSITIVE, number, text, texts},
};
use crate::{Choice, Moment};

/// Reads the keys.
pub(super) fn read(keys: &mut Keys<'_>) -> Choice {
    if keys.has("frame") && keys.has("time") {
        keys.complain("time", Complaint::new("cannot go with \"frame\""));
    }
    let frame = keys.optional("frame", number(ANY)).map(Moment::Frame);
    let time = keys.optional("time", number(ANY)).map(Moment::Seconds);
    Choice {
        variants: keys.optional("variant", names).unwrap_or_default(),
        moment: frame.or(time),
        fps: keys.optional("fps", number(POSITIVE)),
    }
}

/// One name or several.
fn names(value: &DeValue<'_>) -> Result<Vec<String>, Complaint> {
    match value {
        DeValue::Array(_) => texts(value),
        _ => Ok(vec![text(value)?]),
    }
}
