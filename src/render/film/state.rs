//! A film taken apart into integers and put together again, and sums of films.
//!
//! Rounds are added as integers, so whatever order and whatever parts they come in, the film is the same to the last
//! bit: that is what makes resumed and distributed renders equal to uninterrupted ones.

use super::{BLOCK_SIDES, Blocks, Film};

/// Exponents of units that a double holds with room for squares.
const UNITS: std::ops::RangeInclusive<i32> = -500..=500;
/// Sums stay below it, so that two of them still fit.
const BOUND: i128 = 1 << 126;

/// What a film is besides its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmState {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Binary logarithm of the brightness that counts as 1.
    pub unit_bits: i32,
    /// Number of rounds.
    pub rounds: u64,
    /// Deposits left out because they were negative or not finite.
    pub rejected: u64,
}

impl FilmState {
    /// Number of sums of such a film with blocks; `None` where there is no such film.
    pub fn sums(&self) -> Option<usize> {
        let (width, height) = (self.width as usize, self.height as usize);
        let pixels = width.checked_mul(height).filter(|&n| n > 0)?;
        let blocks = BLOCK_SIDES.iter().map(|side| width.div_ceil(*side) * height.div_ceil(*side));
        pixels.checked_mul(2)?.checked_add(blocks.sum::<usize>())?.checked_add(1)?.checked_mul(3)
    }
}

impl Film {
    /// What it is besides its sums; `None` for films without blocks.
    pub fn state(&self) -> Option<FilmState> {
        let width = self.blocks.as_ref()?.width;
        Some(FilmState {
            width: width as u32,
            height: (self.pixels() / width) as u32,
            unit_bits: self.unit_bits,
            rounds: self.rounds,
            rejected: self.rejected,
        })
    }

    /// Its sums: three a pixel, three squares a pixel, then those of the blocks.
    pub fn sums(&self) -> impl Iterator<Item = i128> {
        let blocks = self.blocks.iter().flat_map(|blocks| blocks.squares.iter().flatten());
        self.sum.iter().chain(&self.squares).chain(blocks).copied()
    }

    /// The film of these numbers; `None` if no film has them.
    pub fn restore(state: FilmState, sums: Vec<i128>) -> Option<Self> {
        let possible = UNITS.contains(&state.unit_bits)
            && state.rounds <= u32::MAX.into()
            && state.sums() == Some(sums.len())
            && sums.iter().all(|sum| (0..BOUND).contains(sum));
        if !possible {
            return None;
        }
        let (width, height) = (state.width as usize, state.height as usize);
        let mut sums = sums.into_iter();
        let mut take = |n: usize| -> Vec<i128> { sums.by_ref().take(n).collect() };
        let (sum, squares) = (take(width * height * 3), take(width * height * 3));
        let mut blocks = Blocks::new(width, height);
        for level in &mut blocks.squares {
            *level = take(level.len());
        }
        let FilmState { unit_bits, rounds, rejected, .. } = state;
        Some(Self { sum, squares, blocks: Some(blocks), rounds, rejected, unit_bits })
    }

    /// Adds the rounds of another film; `false`, and nothing changed, where size or unit differ or one keeps no blocks.
    pub fn add(&mut self, other: &Self) -> bool {
        let (Some(mine), Some(theirs)) = (&mut self.blocks, &other.blocks) else { return false };
        if mine.width != theirs.width
            || self.sum.len() != other.sum.len()
            || self.unit_bits != other.unit_bits
        {
            return false;
        }
        let total = |mine: &mut Vec<i128>, theirs: &[i128]| {
            mine.iter_mut().zip(theirs).for_each(|(a, b)| *a = a.saturating_add(*b));
        };
        total(&mut self.sum, &other.sum);
        total(&mut self.squares, &other.squares);
        mine.squares.iter_mut().zip(&theirs.squares).for_each(|(mine, theirs)| total(mine, theirs));
        self.rounds += other.rounds;
        self.rejected = self.rejected.saturating_add(other.rejected);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::Rgb,
        rng::{Purpose, Rng},
    };

    const WIDTH: usize = 70;
    const HEIGHT: usize = 20;

    fn film(rounds: impl Iterator<Item = u32>) -> Film {
        let mut film = Film::new(WIDTH * HEIGHT, 0.3).with_blocks(WIDTH);
        for index in rounds {
            let (round, mut rng) = (film.round(), Rng::new(3, Purpose::Test, index, 0));
            (0..WIDTH * HEIGHT).for_each(|pixel| round.add(pixel, Rgb::new(rng.f64(), rng.f64(), 0.0)));
            round.add(0, Rgb::NAN);
            film.merge(&round, 0.7);
        }
        film
    }

    #[test]
    fn a_film_survives_being_taken_apart() {
        let film = film(0..5);
        let state = film.state().expect("it has blocks");
        assert_eq!(Film::restore(state, film.sums().collect()), Some(film));
    }

    #[test]
    fn any_split_of_the_rounds_adds_up_to_the_whole() {
        let whole = film(0..7);
        for parts in 1..=7 {
            let mut sum = film(0..0);
            for part in (0..parts).rev() {
                assert!(sum.add(&film((part..7).step_by(parts as usize))));
            }
            assert_eq!(sum, whole, "{parts} parts");
        }
    }

    #[test]
    fn films_that_do_not_fit_are_not_added() {
        let mut sum = film(0..2);
        let before = sum.clone();
        let turned = Film::new(WIDTH * HEIGHT, 0.3).with_blocks(HEIGHT);
        let brighter = Film::new(WIDTH * HEIGHT, 30.0).with_blocks(WIDTH);
        for other in [turned, brighter, Film::new(WIDTH * HEIGHT, 0.3)] {
            assert!(!sum.add(&other));
        }
        assert_eq!(sum, before);
    }

    #[test]
    fn numbers_of_no_film_are_refused() {
        let film = film(0..2);
        let (state, sums) = (film.state().expect("it has blocks"), film.sums().collect::<Vec<_>>());
        for state in [
            FilmState { width: 0, ..state },
            FilmState { width: u32::MAX, height: u32::MAX, ..state },
            FilmState { height: state.height + 1, ..state },
            FilmState { unit_bits: 1 << 20, ..state },
            FilmState { rounds: u64::MAX, ..state },
        ] {
            assert_eq!(Film::restore(state, sums.clone()), None, "{state:?}");
        }
        for wrong in [-1, i128::MAX] {
            let sums = sums.iter().map(|_| wrong).collect();
            assert_eq!(Film::restore(state, sums), None, "{wrong}");
        }
        assert_eq!(Film::restore(state, sums[1..].to_vec()), None);
    }
}
