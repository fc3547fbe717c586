//! The hierarchy: where things are, and how often.

use glam::DAffine3;
use serde::{Deserialize, Serialize};

use crate::{Camera, Id, Light, Material, Mesh};

/// A place in the hierarchy. A mesh that several nodes name is an instance in each of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Name from the asset; not necessarily unique.
    pub name: String,
    /// From this node's space to its parent's.
    pub transform: DAffine3,
    /// Nodes below, each with exactly one parent.
    pub children: Vec<Id<Node>>,
    /// Meshes placed here.
    pub meshes: Vec<Id<Mesh>>,
    /// Replaces the material of all `meshes` of this node.
    pub material: Option<Id<Material>>,
    /// A light placed here.
    pub light: Option<Id<Light>>,
    /// A camera placed here.
    pub camera: Option<Id<Camera>>,
    /// `false` hides this node's meshes and lights and those below it, not the cameras.
    pub visible: bool,
}

impl Default for Node {
    fn default() -> Self {
        Self {
            name: String::new(),
            transform: DAffine3::IDENTITY,
            children: Vec::new(),
            meshes: Vec::new(),
            material: None,
            light: None,
            camera: None,
            visible: true,
        }
    }
}
