//! Files that are broken or mean harm: each must be refused with a message, or read with warnings, in little time and
//! memory, and never by a panic.

mod corpus;
mod damaged;
mod gltf;
mod images;
mod jail;
mod obj;
mod scene_file;
