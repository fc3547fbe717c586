//! Mounts that the system tells nothing about: what others change there is seen only by looking.

use std::path::Path;

/// Types of such file systems (proc(5), mountinfo).
const REMOTE: &[&str] = &[
    "9p", "afs", "ceph", "cifs", "drvfs", "lustre", "ncpfs", "nfs", "nfs4", "prl_fs", "smb3", "smbfs",
    "vboxsf", "virtiofs",
];

/// Whether the file lies, or would lie, on such a mount.
pub(super) fn is_remote(path: &Path) -> bool {
    let mounts = std::fs::read_to_string("/proc/self/mountinfo").unwrap_or_default();
    kind_of(path, &mounts).is_some_and(|kind| REMOTE.contains(&kind) || kind.starts_with("fuse"))
}

/// Type of the mount that holds the path; later mounts lie over earlier ones.
fn kind_of<'a>(path: &Path, mounts: &'a str) -> Option<&'a str> {
    let mount = |line: &'a str| {
        let (before, after) = line.split_once(" - ")?;
        let point = unescape(before.split(' ').nth(4)?);
        path.starts_with(&point).then(|| (point.len(), after.split(' ').next().unwrap_or_default()))
    };
    mounts.lines().filter_map(mount).max_by_key(|(length, _)| *length).map(|(_, kind)| kind)
}

/// Blanks and the like are written as `\040`.
fn unescape(point: &str) -> String {
    [("\\040", " "), ("\\011", "\t"), ("\\012", "\n"), ("\\134", "\\")]
        .iter()
        .fold(point.to_owned(), |text, (code, character)| text.replace(code, character))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOUNTS: &str = "\
22 1 8:1 / / rw,relatime - ext4 /dev/sda1 rw
30 22 0:40 / /mnt/assets rw shared:1 - nfs4 server:/assets rw
31 22 0:41 / /mnt/my\\040disk rw - fuse.sshfs me@there: rw
32 30 8:2 / /mnt/assets/local rw - xfs /dev/sdb rw
";

    #[test]
    fn the_innermost_mount_counts() {
        let of = |path| kind_of(Path::new(path), MOUNTS);
        assert_eq!(of("/home/me/scene.toml"), Some("ext4"));
        assert_eq!(of("/mnt/assets/chair.glb"), Some("nfs4"));
        assert_eq!(of("/mnt/assetsbeside/chair.glb"), Some("ext4"));
        assert_eq!(of("/mnt/assets/local/chair.glb"), Some("xfs"));
        assert_eq!(of("/mnt/my disk/chair.glb"), Some("fuse.sshfs"));
        assert_eq!(kind_of(Path::new("/a"), ""), None);
    }
}
