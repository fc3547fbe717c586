//! What imports are asked for: variants and moments.

use std::cell::RefCell;

use super::{super::Overrides, folder, import, load, wrong};
use crate::{Choice, ImportRequest, Moment};

/// What the importer is asked for by an `[[import]]` with these keys.
fn asked(keys: &str) -> Choice {
    let toml = format!("[[import]]\nfile = \"a.glb\"\n{keys}\n");
    let folder = folder(&toml, &["a.glb"]);
    let choice = RefCell::default();
    load(&ImportRequest::new(folder.path().join("scene.toml")), &Overrides::default(), &|request| {
        choice.replace(request.choice.clone());
        import(request)
    })
    .unwrap();
    choice.into_inner()
}

#[test]
fn keys_become_choices() {
    assert_eq!(asked(""), Choice::default());
    assert_eq!(asked("variant = \"Red\"").variants, ["Red"]);
    assert_eq!(
        asked("variant = [\"/A:look=red\", \"/B:size=big\"]").variants,
        ["/A:look=red", "/B:size=big"]
    );
    assert_eq!(asked("frame = -2.5").moment, Some(Moment::Frame(-2.5)));
    let timed = asked("time = 3\nfps = 30");
    assert_eq!(
        (timed.moment, timed.fps, timed.seconds()),
        (Some(Moment::Seconds(3.0)), Some(30.0), Some(3.0))
    );
}

#[test]
fn frames_become_seconds() {
    assert_eq!(asked("frame = 12").seconds(), Some(0.5));
    assert_eq!(asked("frame = 12\nfps = 6").seconds(), Some(2.0));
    assert_eq!(asked("fps = 6").seconds(), None);
}

#[test]
fn the_first_choice_goes_before_the_second() {
    let (first, second) = (asked("frame = 1"), asked("time = 2\nfps = 30\nvariant = \"Red\""));
    assert_eq!(first.or(&second), asked("frame = 1\nfps = 30\nvariant = \"Red\""));
    assert_eq!(second.or(&first), second);
}

#[test]
fn contradictions_are_errors() {
    let import = "[[import]]\nfile = \"a.glb\"\n";
    let both = wrong(&format!("{import}frame = 1\ntime = 2"), &["a.glb"]);
    assert_eq!(both[0], "4:8: error: import[0].time: cannot go with \"frame\"");
    for bad in ["fps = 0", "fps = -1", "variant = \"\"", "variant = 1", "frame = \"1\""] {
        let said = wrong(&format!("{import}{bad}"), &["a.glb"]);
        assert!(said[0].starts_with("3:"), "{bad}: {said:?}");
    }
}
