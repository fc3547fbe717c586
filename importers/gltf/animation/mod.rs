//! Animations (specification, section 3.11) at a moment. What a channel moves gets its value in the JSON, before that is
//! turned into a scene: KHR_animation_pointer then needs nothing that node transforms do not need.

mod keyframes;
mod pointer;

use std::collections::HashSet;

use ajar_scene::Diagnostic;
use serde::Deserialize;
use serde_json::{Map, Value};

use super::{Asset, Context, at, extensions};
use keyframes::Keyframes;
use pointer::Pointer;

#[derive(Deserialize)]
struct Animation {
    #[serde(default)]
    channels: Vec<Channel>,
    #[serde(default)]
    samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
struct Channel {
    sampler: u32,
    target: Target,
}

#[derive(Deserialize)]
struct Target {
    node: Option<u32>,
    path: String,
    #[serde(default)]
    extensions: Map<String, Value>,
}

#[derive(Deserialize)]
struct Sampler {
    input: u32,
    output: u32,
    #[serde(default)]
    interpolation: Option<String>,
}

/// KHR_animation_pointer.
#[derive(Deserialize)]
struct PointsTo {
    pointer: String,
}

/// Writes into `document` what all `animations` show at a time in seconds. Where several move the same thing the first
/// counts.
///
/// # Errors
/// An accessor is broken, or an index points beyond its list.
pub(super) fn apply(
    animations: &[Value],
    seconds: f64,
    asset: &Asset,
    context: &mut Context,
    document: &mut Map<String, Value>,
) -> Result<(), Diagnostic> {
    let mut moved = HashSet::new();
    for (i, animation) in animations.iter().enumerate() {
        let element = format!("animations[{i}]");
        let animation: Animation = match serde_path_to_error::deserialize(animation) {
            Ok(animation) => animation,
            Err(error) => {
                let element = extensions::below(&element, error.path());
                context.report.warn(element, format!("the animation is dropped: {}", error.inner()));
                continue;
            }
        };
        for (j, channel) in animation.channels.iter().enumerate() {
            let element = format!("{element}.channels[{j}]");
            let Some(pointer) = pointer(channel, context, &element) else { continue };
            if !moved.insert(pointer.clone()) {
                context
                    .report
                    .approximate(element, "several animations move the same thing; the first counts");
                continue;
            }
            let user = format!("{element}.sampler");
            let sampler = at(&animation.samplers, channel.sampler as usize, "samplers", &user)?;
            let element = format!("animations[{i}].samplers[{}]", channel.sampler);
            let value =
                Keyframes::open(asset, context, sampler, &element)?.at(seconds, pointer.is_rotation());
            if let Err(why) = pointer.set(document, &value) {
                context.report.warn(element, format!("the animation of {pointer} is dropped: {why}"));
            }
        }
    }
    Ok(())
}

/// What a channel moves, if that is anything a scene can show.
fn pointer(channel: &Channel, context: &mut Context, element: &str) -> Option<Pointer> {
    let Target { node, path, extensions: others } = &channel.target;
    if path != "pointer" {
        return node.map(|node| Pointer::node(node, path));
    }
    let found: PointsTo =
        extensions::read(Some(others), "KHR_animation_pointer", element, &mut context.report)?;
    Some(Pointer::new(&found.pointer))
}
