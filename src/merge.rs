//! The shards of a render put together: to the last bit what one machine would have rendered, for films are integers.

use std::path::{Path, PathBuf};

use ajar_scene::{Cause, Diagnostic};

use crate::{
    checkpoint::{Saved, open},
    shard::Shard,
};

/// Numbers of missing shards that are named at most.
const MOST_NAMED: usize = 10;

/// A part that was added.
struct Part<'a> {
    path: &'a Path,
    shard: Shard,
    rounds: u64,
}

/// Adds up the shards in `paths`, in any order. One file at a time is in memory beside the sum.
///
/// # Errors
/// Files that are no checkpoints, are of different renders, or are not all the shards of one with all their rounds.
pub fn merge(paths: &[PathBuf]) -> Result<Saved, Vec<Diagnostic>> {
    let mut sum: Option<Saved> = None;
    let mut parts: Vec<Part<'_>> = Vec::new();
    for path in paths {
        let saved = open(path).map_err(|d| vec![d])?;
        if let Some(twin) = parts.iter().find(|part| part.shard == saved.shard) {
            let again = format!("holds shard {}, as {} does", saved.shard, twin.path.display());
            return Err(vec![wrong(again).in_file(path)]);
        }
        parts.push(Part { path, shard: saved.shard, rounds: saved.film.rounds() });
        match &mut sum {
            None => sum = Some(saved),
            Some(sum) => add(sum, &saved, path)?,
        }
    }
    let sum = sum.ok_or_else(|| vec![wrong("nothing to merge")])?;
    check_complete(&parts, sum.shard.count)?;
    Ok(Saved { shard: Shard::WHOLE, ..sum })
}

fn wrong(message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(message).because(Cause::Usage)
}

fn add(sum: &mut Saved, part: &Saved, path: &Path) -> Result<(), Vec<Diagnostic>> {
    let mut differences = part.subject.differences(&sum.subject, path);
    if part.shard.count != sum.shard.count {
        let other = format!("holds shard {} of a render of {} shards", part.shard, sum.shard.count);
        differences.push(wrong(other).in_file(path));
    }
    if !differences.is_empty() {
        return Err(differences);
    }
    if !sum.film.add(&part.film) {
        return Err(vec![
            Diagnostic::error("counts light in other units than the other parts").in_file(path),
        ]);
    }
    sum.complete &= part.complete;
    sum.seconds += part.seconds;
    Ok(())
}

/// Whether all of `count` shards are there, and have all the rounds of the one that went farthest.
fn check_complete(parts: &[Part<'_>], count: u32) -> Result<(), Vec<Diagnostic>> {
    let missing = |index: &u32| parts.iter().all(|part| part.shard.index != *index);
    let names: Vec<_> =
        (0..count).filter(missing).take(MOST_NAMED).map(|index| format!("{index}/{count}")).collect();
    let untold = (count as usize).saturating_sub(parts.len() + names.len());
    if !names.is_empty() {
        let more = if untold > 0 { format!(" and {untold} more") } else { String::new() };
        return Err(vec![wrong(format!("shards are missing: {}{more}", names.join(", ")))]);
    }
    let total = parts.iter().map(|part| part.shard.least_total(part.rounds)).max().unwrap_or(0);
    let behind = parts.iter().filter(|part| part.rounds < part.shard.share(total));
    let errors: Vec<_> = behind
        .map(|part| {
            let (rounds, share) = (part.rounds, part.shard.share(total));
            Diagnostic::error(format!("shard {} has {rounds} of its {share} rounds", part.shard))
                .in_file(part.path)
                .hint(format!("go on with it: ajar render … --resume {}", part.path.display()))
        })
        .collect();
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}
