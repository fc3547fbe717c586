//! What became of a file that was imported, in one line.

use ajar_scene::{Diagnostic, Loss, Scene};

use crate::words::many;

/// `kept 2 meshes of 24 triangles, 1 light; 3 things approximated, 1 dropped`, after what importers said of losses.
pub(crate) fn kept(scene: &Scene, diagnostics: &[Diagnostic]) -> Diagnostic {
    let triangles = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let meshes = format!("{} of {}", many(scene.meshes.len(), "mesh"), many(triangles, "triangle"));
    let others = [
        (scene.materials.len(), "material"),
        (scene.textures.len(), "texture"),
        (scene.lights.len(), "light"),
        (scene.cameras.len(), "camera"),
    ];
    let others = others.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| many(count, what));
    let things: Vec<_> = (!scene.meshes.is_empty()).then_some(meshes).into_iter().chain(others).collect();
    let things = if things.is_empty() { "nothing".to_owned() } else { things.join(", ") };
    Diagnostic::note(format!("kept {things}; {}", losses(diagnostics)))
}

/// `3 things approximated, 1 dropped`.
fn losses(diagnostics: &[Diagnostic]) -> String {
    let count = |loss| diagnostics.iter().filter(|it| it.loss == Some(loss)).count();
    match (count(Loss::Approximated), count(Loss::Dropped)) {
        (0, 0) => "nothing approximated or dropped".to_owned(),
        (approximated, dropped) => format!("{} approximated, {dropped} dropped", many(approximated, "thing")),
    }
}

#[cfg(test)]
mod tests {
    use ajar_scene::Mesh;

    use super::*;

    #[test]
    fn things_and_losses_are_counted() {
        let mut scene = Scene::default();
        assert_eq!(kept(&scene, &[]).message, "kept nothing; nothing approximated or dropped");
        scene.meshes.push(Mesh { triangles: vec![[0, 1, 2]; 2], ..Mesh::default() });
        scene.materials.push(Default::default());
        let said = [
            Diagnostic::warning("a").losing(Loss::Approximated),
            Diagnostic::warning("b").losing(Loss::Dropped),
            Diagnostic::warning("c"),
        ];
        assert_eq!(
            kept(&scene, &said).message,
            "kept 1 mesh of 2 triangles, 1 material; 1 thing approximated, 1 dropped"
        );
    }
}
