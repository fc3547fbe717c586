//! Images that are as good as they were asked to be.

use ajar_integrators::features::features;
use ajar_scene::{Cause, Diagnostic};

use super::{
    Phase, View, Watch,
    opened::{Opened, Output},
};
use crate::{
    image::{self, Destination, Run},
    session::Rendered,
    shard::Shard,
};

impl Watch<'_> {
    /// The render at work has ended by itself.
    pub(super) fn end_image(&mut self, view: &mut dyn View) {
        let Some(worker) = self.worker.take() else { return };
        let resting = worker.rest();
        let Some(opened) = &self.opened else { return };
        self.state.phase = Phase::Stopped;
        self.is_news = true;
        let Some(resting) = resting else {
            let fault = "rendering failed in a way that is a fault of this program";
            self.state.errors = vec![Diagnostic::error(fault).because(Cause::System)];
            return view.say(&self.state.errors);
        };
        let rendered = &resting.rendered;
        self.state.status(&rendered.status, &opened.plan);
        if rendered.reason.is_some() {
            self.state.phase = Phase::Done;
            self.state.seconds_left = None;
            // Part of an image is for those who look at it.
            let is_wanted = self.subject.wants_images() && self.region.is_none();
            let output = opened.output.as_ref().filter(|_| is_wanted);
            match output.map(|output| write(opened, output, rendered)).transpose() {
                Ok(notes) => {
                    view.say(&notes.unwrap_or_default());
                    view.finish(&self.state, output.map(|output| &output.to));
                }
                Err(error) => {
                    self.state.errors = vec![error];
                    view.say(&self.state.errors);
                }
            }
        }
        self.resting = Some(resting);
    }
}

fn write(opened: &Opened, output: &Output, rendered: &Rendered) -> Result<Vec<Diagnostic>, Diagnostic> {
    write_as(&output.to, opened, output, rendered, None)
}

/// Writes an image of a scene, with what people should know of it.
pub(super) fn write_as(
    to: &Destination,
    opened: &Opened,
    output: &Output,
    rendered: &Rendered,
    comment: Option<&str>,
) -> Result<Vec<Diagnostic>, Diagnostic> {
    let plan = &opened.plan;
    let run = Run {
        camera: &opened.camera,
        size: plan.size,
        features: &features(&opened.world, plan.settings.window),
        integrator: plan.integrator.name(),
        settings: &plan.settings,
        film: &rendered.film,
        shard: Shard::WHOLE,
        status: &rendered.status,
        complete: rendered.reason.is_some(),
        report: &rendered.report,
        scene_hash: &output.hash,
        comment,
    };
    image::write(&run, to).map_err(|e| Diagnostic::error(e.to_string()).because(Cause::System))
}
