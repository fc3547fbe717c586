//! The surroundings: skies, uniform light and sun discs, infinitely far in all directions.
//!
//! Radiance is the sum of the components. Directions are sampled from the mixture of the components' own distributions,
//! weighted by power; each of them is positive wherever its component shines and has an exact inverse. A direction
//! points from the scene to the surroundings.

mod sky;
mod sun;

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use sky::Sky;
use sun::Sun;

use crate::{
    distribution::Discrete,
    math::{Rgb, scalar},
    texture::Texture,
    warp,
};

/// One of the lights that make the surroundings.
#[derive(Clone, Debug)]
enum Component {
    /// The same radiance from everywhere, cd/m².
    Uniform(Rgb),
    Sky(Sky),
    Sun(Sun),
}

/// All lights infinitely far that have an extent; the default is black.
#[derive(Clone, Debug, Default)]
pub struct Environment {
    components: Vec<Component>,
    choice: Discrete,
}

impl Environment {
    /// Adds the same radiance from everywhere, cd/m².
    pub fn add_uniform(&mut self, radiance: Rgb) {
        self.add(Component::Uniform(radiance));
    }

    /// Adds a latitude-longitude image times `radiance` (cd/m²). Pole +Y; seen from inside, its centre faces +Z and its
    /// left edge is at longitude +π, then turned by the rotation `world_from_light`. Of the texture's own settings wraps
    /// and transform do not count; negative radiance counts as none.
    pub fn add_image(&mut self, texture: Texture, world_from_light: DMat3, radiance: Rgb) {
        if let Some(sky) = Sky::new(texture, radiance, world_from_light) {
            self.add(Component::Sky(sky));
        }
    }

    /// Adds a disc of uniform radiance around the unit vector `centre` with the full angle `angle` in [10⁻⁶, π] radians,
    /// that gives a surface facing it `illuminance` lux a channel.
    pub fn add_sun(&mut self, centre: DVec3, angle: f64, illuminance: Rgb) {
        self.add(Component::Sun(Sun::new(centre, angle, illuminance)));
    }

    /// Components that do not shine are left out.
    fn add(&mut self, component: Component) {
        if scalar(component.flux()) > 0.0 {
            self.components.push(component);
            let powers: Vec<f64> = self.components.iter().map(|component| scalar(component.flux())).collect();
            self.choice = Discrete::new(&powers);
        }
    }

    /// Whether no light comes from anywhere.
    pub fn is_empty(&self) -> bool {
        self.components.is_empty()
    }

    /// Radiance from the unit direction `direction`, cd/m².
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.components.iter().map(|component| component.radiance(direction)).sum()
    }

    /// Chooses a component with `choice` and in it a unit direction with `u`, all in [0, 1). The direction's density is
    /// [`pdf`](Self::pdf), whichever component it came from. Black surroundings give +Y, which has density 0.
    pub fn sample(&self, choice: f64, u: [f64; 2]) -> (usize, DVec3) {
        let component = self.choice.sample(choice).map_or(0, |(component, ..)| component);
        (component, self.components.get(component).map_or(DVec3::Y, |component| component.sample(u)))
    }

    /// Density of [`sample`](Self::sample) per solid angle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let densities = self.components.iter().enumerate();
        densities.map(|(i, component)| self.choice.pmf(i) * component.pdf(direction)).sum()
    }

    /// The numbers `u` for which component number `component` gives `direction`; `None` if it never does.
    pub fn invert(&self, component: usize, direction: DVec3) -> Option<[f64; 2]> {
        self.components.get(component)?.invert(direction)
    }

    /// Probability that [`sample`](Self::sample) chooses a component; 0 for numbers without component.
    pub fn component_pmf(&self, component: usize) -> f64 {
        self.choice.pmf(component)
    }

    /// Radiance averaged over all directions, cd/m².
    pub fn mean_radiance(&self) -> Rgb {
        self.components.iter().map(Component::flux).sum::<Rgb>() / (4.0 * PI)
    }

    /// Integral of the radiance's channel mean over all directions, lx. Times the area of a disc it is the flux
    /// through that disc facing each direction in turn.
    pub fn power(&self) -> f64 {
        self.choice.total()
    }
}

impl Component {
    fn radiance(&self, direction: DVec3) -> Rgb {
        match self {
            Self::Uniform(radiance) => *radiance,
            Self::Sky(sky) => sky.radiance(direction),
            Self::Sun(sun) => sun.radiance(direction),
        }
    }

    /// Integral of radiance over solid angle.
    fn flux(&self) -> Rgb {
        match self {
            Self::Uniform(radiance) => *radiance * 4.0 * PI,
            Self::Sky(sky) => sky.flux(),
            Self::Sun(sun) => sun.flux(),
        }
    }

    fn sample(&self, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Uniform(_) => warp::square_to_sphere(u),
            Self::Sky(sky) => sky.sample(u),
            Self::Sun(sun) => sun.sample(u),
        }
    }

    fn pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Uniform(_) => 0.25 / PI,
            Self::Sky(sky) => sky.pdf(direction),
            Self::Sun(sun) => sun.pdf(direction),
        }
    }

    fn invert(&self, direction: DVec3) -> Option<[f64; 2]> {
        match self {
            Self::Uniform(_) => Some(warp::sphere_to_square(direction)),
            Self::Sky(sky) => sky.invert(direction),
            Self::Sun(sun) => sun.invert(direction),
        }
    }
}

#[cfg(test)]
mod tests;
