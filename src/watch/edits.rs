//! What pages ask for, done.

use std::{collections::BTreeMap, time::Instant};

use ajar_integrators::{Window, features::features};
use ajar_live::server::Reply;
use ajar_scene::{Diagnostic, Projection};
use glam::DVec3;
use serde_json::json;
use toml::{Table, Value};

use super::{
    Phase, View as Told, Watch,
    describe::{is_nameless, is_of_file},
    draft::{Draft, Kind},
    layer,
    opened::Opened,
    page::{Request, View},
};

/// What a camera that a page made is called.
const VIEW: &str = "view";

impl Watch<'_> {
    pub(super) fn answer(&mut self, request: Request, reply: &Reply, view: &mut dyn Told) {
        self.is_news = true;
        if self.is_taken_back && !matches!(request, Request::Probe { .. }) {
            // Who asks for something else has seen why.
            self.is_taken_back = false;
            self.state.errors.clear();
        }
        match request {
            Request::Stop {} if self.worker.is_some() => {
                self.rest();
                self.state.phase = Phase::Stopped;
            }
            Request::Continue {} if self.worker.is_none() && !self.is_stale => self.go_on(),
            Request::Stop {} | Request::Continue {} => {}
            Request::Restart {} => self.begin_again(),
            Request::Region { pixels } => self.choose_region(pixels),
            Request::Probe { x, y } => self.probe(x, y, reply),
            Request::Camera(view) => self.edit("camera", |draft, opened| look_from(draft, opened, view)),
            Request::Through { camera } => self.edit("camera", |draft, _| draft.look_through(camera)),
            Request::Variants { import, variants } => {
                let what = if variants.is_empty() { "variant as it was".into() } else { variants.join(", ") };
                self.edit(&what, |draft, _| draft.show_variants(import, variants));
            }
            Request::Set(setting) => self.edit(&setting.label(), |draft, _| draft.set(setting.clone())),
            Request::Clay { show } => {
                self.edit(if show { "clay" } else { "clay off" }, |draft, _| draft.show_clay(show));
            }
            Request::Revert {} => self.edit("edits dropped", |draft, _| draft.clear()),
            Request::Save {} => self.save(view),
        }
    }

    /// Changes the draft.
    fn edit(&mut self, what: &str, change: impl FnOnce(&mut Draft, &Opened)) {
        let Some(opened) = &self.opened else { return };
        let before = self.draft.clone();
        change(&mut self.draft, opened);
        if self.draft != before {
            self.state.note([what.to_owned()]);
            (self.state.saved, self.state.saved_without) = (None, Vec::new());
            self.gesture.step(what, Instant::now());
            self.outdate();
        }
    }

    fn choose_region(&mut self, pixels: Option<[u32; 4]>) {
        let Some(opened) = &mut self.opened else { return };
        let [width, height] = opened.plan.size;
        let region = pixels.map(|[x0, y0, x1, y1]| Window { x0, y0, x1, y1 });
        let inside = region.and_then(|region| cut(region, opened.plan.size));
        if region.is_some() && inside.is_none() {
            // Drawn beside the image.
            return;
        }
        self.region = inside;
        opened.plan.settings.window = inside.unwrap_or(Window { x0: 0, y0: 0, x1: width, y1: height });
        self.begin_again();
    }

    fn probe(&self, x: u32, y: u32, reply: &Reply) {
        let Some((value, error)) = self.screen.pixel(x, y) else { return };
        let answer = json!({
            "type": "probe", "x": x, "y": y,
            // JSON has no NaN; a page takes null for it.
            "value": value, "error": error,
            "hit": self.opened.as_ref().and_then(|opened| what_is_at(opened, x, y)),
        });
        reply.send(answer.to_string());
    }

    fn save(&mut self, view: &mut dyn Told) {
        let Some(opened) = &self.opened else { return };
        let scene = self.subject.path();
        let said = self.subject.said(&opened.camera.0.name);
        match self.layer.save(scene, layer::text(&self.draft, scene, &said)) {
            Ok(path) => {
                self.state.saved = Some(path.display().to_string());
                self.state.saved_without = said.not_in_layer(scene);
                let mut note = Diagnostic::note("changes saved").in_file(path);
                if !self.state.saved_without.is_empty() {
                    note = note.hint(format!("it does not hold {}", self.state.saved_without.join(", ")));
                }
                view.say(&[note]);
            }
            Err(error) => self.state.errors = vec![error],
        }
    }
}

/// What of a region lies in an image of this size.
pub(super) fn cut(region: Window, [width, height]: [u32; 2]) -> Option<Window> {
    let inside = Window { x1: region.x1.min(width), y1: region.y1.min(height), ..region };
    (inside.x0 < inside.x1 && inside.y0 < inside.y1).then_some(inside)
}

/// Names of the object and of the material at a pixel, and where they are, if there is something.
fn what_is_at(opened: &Opened, x: u32, y: u32) -> Option<serde_json::Value> {
    let world = &opened.world;
    let hits = features(world, Window { x0: x, y0: y, x1: x + 1, y1: y + 1 });
    let hit = hits.first().filter(|hit| hit.object > 0)?;
    let instance = world.instances().get(hit.object as usize - 1);
    let object = instance.and_then(|it| world.scene.nodes.get(it.node)).map(|node| &node.name);
    let material =
        hit.material.checked_sub(1).and_then(|index| world.scene.materials.iter().nth(index as usize));
    Some(json!({
        "object": object,
        "material": material.map(|material| &material.name),
        "depth": hit.depth,
        "normal": hit.normal.to_array(),
    }))
}

/// The point that the camera turns about: what is in the middle of the image, else where it is in focus.
pub(super) fn pivot(opened: &Opened) -> DVec3 {
    let (camera, place) = &opened.camera;
    let [width, height] = opened.plan.size;
    let (x, y) = (width / 2, height / 2);
    let hit = features(&opened.world, Window { x0: x, y0: y, x1: x + 1, y1: y + 1 });
    let depth = hit.first().map(|hit| f64::from(hit.depth)).filter(|depth| *depth > 0.0);
    let focus = match camera.projection {
        Projection::Perspective { focus_distance, .. } => f64::from(focus_distance),
        Projection::Orthographic { half_height } => f64::from(half_height),
    };
    place.translation - place.matrix3.z_axis.normalize_or(DVec3::Z) * depth.unwrap_or(focus)
}

/// Moves the camera that is looked through, or one like it where scene files cannot move that.
fn look_from(draft: &mut Draft, opened: &Opened, view: View) {
    let name = &opened.camera.0.name;
    let of_file = name == VIEW || is_of_file("camera", name, &opened.settings);
    let place: BTreeMap<_, _> =
        [("position", view.position), ("target", view.target), ("up", view.up)].into();
    let place = place.into_iter().map(|(key, vector)| (key.to_owned(), numbers(&vector)));
    let half_height = view.half_height.map(|half| ("half_height".to_owned(), shortest(half as f32).into()));
    let place = place.chain(half_height);
    if of_file {
        draft.table(Kind::Camera, name.as_str()).extend(place);
        return;
    }
    let copies = !opened.is_framed && !is_nameless("camera", name, &opened.settings) && !name.is_empty();
    let table = draft.table(Kind::Camera, VIEW);
    if copies {
        table.insert("copy".into(), name.as_str().into());
    } else {
        lens(opened, table);
    }
    table.extend(place);
    draft.look_through(VIEW);
}

/// Says all that a camera is besides its place.
fn lens(opened: &Opened, table: &mut Table) {
    let camera = &opened.camera.0;
    let mut say = |key: &str, value: f32| table.insert(key.into(), shortest(value).into());
    match camera.projection {
        Projection::Orthographic { half_height } => say("half_height", half_height),
        Projection::Perspective { yfov, lens_radius, .. } => {
            say("yfov", yfov.to_degrees());
            say("lens_radius", lens_radius)
        }
    };
    say("exposure", camera.exposure);
}

fn numbers(vector: &[f64; 3]) -> Value {
    // A hundredth of a millimetre is enough for a camera, and reads better.
    vector.iter().map(|x| Value::from((x * 1e5).round() / 1e5)).collect::<Vec<_>>().into()
}

/// The number that reads as this one in single precision.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(value.into())
}
