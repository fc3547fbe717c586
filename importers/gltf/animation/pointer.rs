//! Places in the JSON that animations may move: JSON pointers (RFC 6901) below what the object model of glTF calls mutable.

use std::fmt;

use serde_json::{Map, Number, Value};

/// A place in the document.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Pointer(Vec<String>);

impl Pointer {
    /// A property of a node.
    pub fn node(node: u32, property: &str) -> Self {
        Self(vec!["nodes".into(), node.to_string(), property.into()])
    }

    /// From its text.
    pub fn new(text: &str) -> Self {
        Self(text.split('/').skip(1).map(|token| token.replace("~1", "/").replace("~0", "~")).collect())
    }

    fn tokens(&self) -> Vec<&str> {
        self.0.iter().map(String::as_str).collect()
    }

    /// Whether it is the rotation of a node, a quaternion.
    pub fn is_rotation(&self) -> bool {
        matches!(self.tokens()[..], ["nodes", _, "rotation"])
    }

    /// Indices of textures and the like decide what is where: they do not move.
    fn is_mutable(&self) -> bool {
        match self.tokens()[..] {
            ["nodes", _, "translation" | "rotation" | "scale"] => true,
            ["nodes" | "meshes", _, "weights"] | ["nodes" | "meshes", _, "weights", _] => true,
            ["nodes", _, "extensions", "KHR_node_visibility", "visible"] => true,
            ["cameras", _, "perspective" | "orthographic", _] => true,
            ["materials", _, .., leaf] => !matches!(leaf, "index" | "texCoord"),
            ["extensions", "KHR_lights_punctual" | "EXT_lights_image_based", "lights", _, ..] => true,
            _ => false,
        }
    }

    /// How many numbers a value has, where that is known.
    fn width(&self) -> Option<usize> {
        match self.tokens()[..] {
            ["nodes", _, "rotation"] => Some(4),
            ["nodes", _, "translation" | "scale"] => Some(3),
            _ => None,
        }
    }

    /// Gives the place a value.
    ///
    /// # Errors
    /// Why it cannot have this one.
    pub fn set(&self, document: &mut Map<String, Value>, value: &[f64]) -> Result<(), &'static str> {
        let Some((leaf, above)) = self.0.split_last().filter(|_| self.is_mutable()) else {
            return Err("a still image cannot show it");
        };
        if self.width().is_some_and(|width| width != value.len()) {
            return Err("its values have the wrong type");
        }
        let value = json(leaf, value).ok_or("its value is not finite")?;
        let (list, above) = above.split_first().ok_or("it points to nothing")?;
        let mut place = document.get_mut(list).ok_or("it points to nothing")?;
        for token in above {
            place = below(place, token).ok_or("it points to nothing")?;
        }
        *below(place, leaf).ok_or("it points to nothing")? = value;
        Ok(())
    }
}

impl fmt::Display for Pointer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|token| write!(f, "/{}", token.escape_debug()))
    }
}

/// What a token names in a value; members that are not there are made, for they have defaults.
fn below<'a>(value: &'a mut Value, token: &str) -> Option<&'a mut Value> {
    let index = token.parse::<usize>();
    match value {
        Value::Array(items) => items.get_mut(index.ok()?),
        Value::Object(fields) if index.is_err() => {
            Some(fields.entry(token).or_insert_with(|| Map::new().into()))
        }
        _ => None,
    }
}

/// Numbers as the property of this name has them.
fn json(leaf: &str, value: &[f64]) -> Option<Value> {
    let number = |x: &f64| Number::from_f64(f64::from(*x as f32)).map(Value::Number);
    match value {
        [x] if leaf == "visible" => Some(Value::Bool(*x != 0.0)),
        [x] if leaf != "weights" => number(x),
        _ => value.iter().map(number).collect::<Option<_>>().map(Value::Array),
    }
}
