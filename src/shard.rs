//! Parts of a render that several machines share: shard i of n, counted from 0, renders the rounds r ≡ i (mod n).

use std::{fmt, str::FromStr};

/// Which rounds are rendered here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 0.
    pub index: u32,
    /// Of how many, at least 1.
    pub count: u32,
}

impl Shard {
    /// All rounds.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Whether it is all there is.
    pub fn is_whole(self) -> bool {
        self.count == 1
    }

    /// Number of this shard's round that follows `done` of them; `None` beyond the numbers that rounds can have.
    pub fn round(self, done: u64) -> Option<u32> {
        let round = done.checked_mul(self.count.into())?.checked_add(self.index.into())?;
        u32::try_from(round).ok()
    }

    /// How many of the first `total` rounds are this shard's.
    pub fn share(self, total: u64) -> u64 {
        total.saturating_sub(self.index.into()).div_ceil(self.count.into())
    }

    /// The fewest rounds of the whole render of which `done` are this shard's.
    pub fn least_total(self, done: u64) -> u64 {
        let before = done.saturating_sub(1).saturating_mul(self.count.into());
        if done == 0 { 0 } else { before.saturating_add(u64::from(self.index) + 1) }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        numbers
            .map(|(index, count)| Self { index, count })
            .filter(|shard| shard.index < shard.count)
            .ok_or("give part and number of parts as 0/3, 1/3, 2/3")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_belongs_to_one_shard() {
        for (count, total) in [(1, 5), (3, 7), (3, 9), (4, 2)] {
            let shards = (0..count).map(|index| Shard { index, count });
            let mut rounds: Vec<_> =
                shards.flat_map(|s| (0..s.share(total)).map(move |k| s.round(k))).collect();
            rounds.sort_unstable();
            assert!(
                rounds.into_iter().eq((0..total).map(|r| Some(r as u32))),
                "{count} shards, {total} rounds"
            );
        }
        assert_eq!(Shard { index: 1, count: 2 }.round(1 << 31), None);
    }

    #[test]
    fn the_least_total_has_the_share_and_one_less_has_not() {
        for shard in ["0/1", "0/3", "2/3"].map(|text| text.parse::<Shard>().expect("a shard")) {
            for done in 1..5 {
                let total = shard.least_total(done);
                assert_eq!((shard.share(total), shard.share(total - 1)), (done, done - 1), "{shard}");
            }
        }
    }

    #[test]
    fn shards_are_written_as_two_numbers() {
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        assert_eq!(Shard { index: 2, count: 3 }.to_string(), "2/3");
        for bad in ["", "1", "3/3", "0/0", "-1/3", "1/3/5", "1 / 3", "0/4294967296"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
