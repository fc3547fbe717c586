//! Many who want nothing, and those who do not read, hold nobody up.

use std::{
    io::{Read, Write},
    thread,
};

use super::*;

#[test]
fn a_hundred_connections_that_say_nothing_or_half_hold_nobody_up() {
    let bench = Bench::new(4);
    let connections: Vec<_> = (0..100).map(|_| bench.connect()).collect();
    for mut connection in connections.iter().step_by(2) {
        connection.write_all(b"GET /").unwrap();
    }
    let mut page = bench.open();
    page.say("hello");
    assert_eq!(page.hear(), Some("heard hello".into()));
    assert_eq!(bench.status(&format!("/{TOKEN}/")), 200);
    drop(connections);
}

#[test]
fn connections_that_say_nothing_are_closed_and_only_so_many_are_open() {
    let bench = Bench::new(4);
    let mut page = bench.open();
    let silent: Vec<_> = (0..2 * CONNECTIONS).map(|_| bench.connect()).collect();
    // It waits until one of the others has had its time.
    assert_eq!(bench.status(&format!("/{TOKEN}/")), 200);
    for mut connection in &silent {
        assert_eq!(connection.read(&mut [0]).unwrap(), 0, "closed without a word");
    }
    // A page that says nothing stays.
    page.say("hello");
    assert_eq!(page.hear(), Some("heard hello".into()));
}

#[test]
fn who_does_not_read_an_image_does_not_keep_its_place() {
    let bench = Bench::new(4);
    let path = format!("/{TOKEN}/image/2");
    let mut deaf = bench.connect();
    write!(deaf, "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", bench.port()).unwrap();
    thread::sleep((READING + 1) * PATIENCE);
    let mut heard = Vec::new();
    let end = deaf.read_to_end(&mut heard);
    assert!(end.is_err() || heard.len() < 2048 * 2048 * 6, "all of it, though late");
    assert_eq!(bench.status(&path), 200);
}

#[test]
fn a_page_that_does_not_read_holds_nobody_up() {
    let bench = Bench::new(4);
    let mut deaf = bench.open();
    let mut page = bench.open();
    let mut frame = Arc::new(Frame::default());
    // Far more than the system keeps for one who does not read.
    for shade in 1..=40 {
        let pixels = vec![[shade as f32; 3]; 512 * 512];
        frame = Arc::new(Frame::new(512, 512, &pixels, Some(&frame)));
        bench.stage.show_frame(Arc::clone(&frame));
        while page.part().0[2] == 0 {}
    }
    page.say("hello");
    assert_eq!(page.hear(), Some("heard hello".into()));
    // It is dropped: what the system kept of the frames is all that it can still read.
    thread::sleep(2 * PATIENCE);
    deaf.0.read_to_end(&mut Vec::new()).unwrap();
}
