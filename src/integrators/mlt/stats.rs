//! What chains did: acceptance, reasons of rejections, rays, stuck chains.

use super::{Reject, choice::MAX_MUTATIONS};

/// Counts of one mutation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MutationStats {
    /// Times it was tried.
    pub tried: u64,
    /// Times it proposed a path.
    pub proposed: u64,
    /// Sum of acceptance probabilities.
    pub acceptance: f64,
    /// Proposals dropped because a number in them was not finite.
    pub not_finite: u64,
}

/// Counts of any number of chains.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChainStats {
    /// By mutation.
    pub mutations: [MutationStats; MAX_MUTATIONS],
    /// Rays cast.
    pub rays: u64,
    /// Rejections since the last acceptance.
    waiting: u32,
    /// Longest wait for an acceptance, steps.
    pub longest_wait: u32,
}

impl ChainStats {
    /// A mutation proposed nothing.
    pub fn fail(&mut self, m: usize, reject: Reject) {
        let stats = &mut self.mutations[m];
        stats.tried += 1;
        stats.not_finite += u64::from(reject == Reject::NotFinite);
        self.wait();
    }

    /// A mutation proposed a path that was accepted with probability `acceptance`.
    pub fn count(&mut self, m: usize, acceptance: f64, accepted: bool) {
        let stats = &mut self.mutations[m];
        stats.tried += 1;
        stats.proposed += 1;
        stats.acceptance += acceptance;
        if accepted {
            self.waiting = 0;
        } else {
            self.wait();
        }
    }

    fn wait(&mut self) {
        self.waiting += 1;
        self.longest_wait = self.longest_wait.max(self.waiting);
    }

    /// A chain begins.
    pub fn begin(&mut self) {
        self.waiting = 0;
    }

    /// Adds the counts of other chains.
    pub fn add(&mut self, other: &Self) {
        for (sum, more) in self.mutations.iter_mut().zip(&other.mutations) {
            sum.tried += more.tried;
            sum.proposed += more.proposed;
            sum.acceptance += more.acceptance;
            sum.not_finite += more.not_finite;
        }
        self.rays += other.rays;
        self.longest_wait = self.longest_wait.max(other.longest_wait);
    }

    /// Steps in all.
    pub fn steps(&self) -> u64 {
        self.mutations.iter().map(|m| m.tried).sum()
    }
}
