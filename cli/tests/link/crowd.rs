//! `iiwasim twin` under load: connections without the token, incomplete requests, many pages, many
//! requests. `iiwasim drive` with few open files.

use std::{
    fmt::Write as _,
    io::{ErrorKind, Read as _, Write as _},
    net::TcpStream,
};

use iiwasim_tests::realtime_guard::in_real_time;
use serde_json::json;

use crate::link::{
    page::Address,
    rig::{Process, Rig, wait_for},
};

/// Limit of open files of a twin in these tests: far fewer than the connections.
const FILES: u32 = 256;

/// Upper bound on the memory of a twin, in MB.
const MEMORY_MB: u64 = 200;

fn start(rig: &Rig) -> (Process, Address) {
    let twin = rig.begin_in(&format!("ulimit -n {FILES}"), "twin", &["--port", "0"]);
    let address = Address::of(&twin);
    (twin, address)
}

/// Opens `count` connections that begin a request and never end it; every second one sends nothing
/// at all.
fn half_requests(address: &Address, count: usize) -> Vec<TcpStream> {
    let begin = |i: usize| {
        let mut stream = TcpStream::connect(&address.host).unwrap();
        stream.set_nonblocking(true).unwrap();
        if i.is_multiple_of(2) {
            // The connection may have been closed already.
            let _ = write!(stream, "GET /?token=0 HTTP/1.1\r\nHost: {}\r\nX-", address.host);
        }
        stream
    };
    (0..count).map(begin).collect()
}

/// Returns half of the connections that this process can open in addition to those of its other
/// tests: 600 with a high limit of open files.
fn wave() -> usize {
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let files = limits.lines().find_map(|line| line.strip_prefix("Max open files"));
    let files = files.and_then(|line| line.split_whitespace().next()?.parse().ok());
    // An unlimited value is not a number; without the file, the limit is that of most systems.
    let files: usize = files.unwrap_or(1024);
    (files.saturating_sub(400) / 2).min(600)
}

/// Returns true if the peer has closed the connection.
fn is_closed(stream: &mut TcpStream) -> bool {
    match stream.read(&mut [0; 1000]) {
        Ok(count) => count == 0,
        Err(error) => error.kind() != ErrorKind::WouldBlock,
    }
}

#[test]
fn half_requests_neither_keep_pages_out_nor_stops() {
    in_real_time(|| {
        let rig = Rig::new();
        let (twin, address) = start(&rig);
        let mut open = address.page();
        open.wait_for("live", |live| live["joints_rad"][0].is_number());

        let mut crowd = half_requests(&address, wave());
        open.order("stop", json!({})).unwrap();
        let mut newcomer = address.page();
        newcomer.order("stop", json!({})).unwrap();
        crowd.extend(half_requests(&address, wave()));
        assert!(crowd.len() > FILES as usize);
        open.order("stop", json!({})).unwrap();
        newcomer.order("stop", json!({})).unwrap();
        let host = ("Host", address.host.as_str());
        let page = format!("/?token={}", address.token);
        assert_eq!(address.get(&page, &[host]).0, 200);

        // The silent connections are closed, and the pages are not.
        for stream in &mut crowd {
            wait_for("end of a half request", || is_closed(stream));
        }
        open.order("stop", json!({})).unwrap();
        newcomer.order("stop", json!({})).unwrap();
        twin.interrupt_below(MEMORY_MB);
    });
}

#[test]
fn strangers_take_no_place_of_pages() {
    in_real_time(|| {
        let rig = Rig::parts();
        let (twin, address) = start(&rig);
        let host = ("Host", address.host.as_str());
        let page = format!("/?token={}", address.token);
        // More connections than permitted of any kind, sequentially and concurrently.
        for _ in 0..200 {
            assert_eq!(address.get("/", &[host]).0, 403);
        }
        let mut pages = vec![address.page()];
        let live = format!("/live?token={}", address.token);
        let origin = format!("http://{}", address.host);
        while let Ok(more) = address.connect(&live, Some(&origin)) {
            pages.push(more);
            assert!(pages.len() < 100, "there is no end of pages");
        }
        assert_eq!(address.connect(&live, Some(&origin)).err().unwrap(), 503);
        assert_eq!(address.get(&page, &[host]).0, 200, "requests have places of their own");
        // All of them are served.
        for page in &mut pages {
            page.wait_for("health", |health| health["error"].is_string());
        }
        // A closed page makes room.
        pages.pop();
        wait_for("room", || address.connect(&live, Some(&origin)).is_ok());
        drop(pages);
        twin.signal("INT");
        twin.end().code(0);
    });
}

#[test]
fn a_stop_waits_for_no_other_order() {
    in_real_time(|| {
        // Without a drive, each request takes its full time-out.
        let rig = Rig::parts();
        let (twin, address) = start(&rig);
        let mut pages: Vec<_> = (0..6).map(|_| address.page()).collect();
        let asked = 6 * 8;
        for page in &mut pages {
            for _ in 0..8 {
                page.begin("set_io", json!({ "name": "MediaFlange.LEDBlue", "value": true }));
            }
        }
        // A page has no further pending requests.
        let more =
            pages[1].order("set_io", json!({ "name": "MediaFlange.LEDBlue", "value": true }));
        assert!(more.unwrap_err().contains("under way"));
        let stop = pages[0].begin("stop", json!({}));
        assert!(pages[0].answer(stop).unwrap_err().contains("no drive answers"));
        let answered: usize = pages.iter().map(crate::link::page::Page::answered).sum();
        assert!(answered < asked, "it came last");
        twin.interrupt_below(MEMORY_MB);
    });
}

#[test]
fn long_texts_come_one_at_a_time() {
    in_real_time(|| {
        let rig = Rig::parts();
        let (twin, address) = start(&rig);
        let text = " ".repeat(4 << 20);
        let program = json!({ "name": "long.json", "text": text });
        std::thread::scope(|scope| {
            let uploads: Vec<_> = (0..6).map(|_| scope.spawn(|| address.load(&program))).collect();
            for upload in uploads {
                assert!(upload.join().unwrap().unwrap_err().contains("long.json, line 1"));
            }
        });
        // A page that sends an overlong request is disconnected.
        address.page().cut_off(&format!(
            r#"{{"id":1,"do":"save_position","name":"{}"}}"#,
            "a".repeat(1 << 20)
        ));
        address.page().order("stop", json!({})).unwrap_err();
        // A program of maximum length and number of motions, blended throughout.
        let mut slow = String::new();
        for i in 0..1000 {
            let (to, blend) =
                (4 * (i % 7), if i < 999 { r#", "blend": {"fraction": 0.3}"# } else { "" });
            let comma = if i > 0 { "," } else { "" };
            let _ = write!(
                slow,
                r#"{comma}{{"type": "ptp", "joints_deg": [{to}, {}, 0, {}, 0, 9, {to}]{blend}}}"#,
                4 * (i % 5),
                4 * (i % 3)
            );
        }
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                "motions": [{slow}] }}"#
        );
        let planned = address.load(&json!({ "name": "many.json", "text": text }));
        planned.unwrap();
        address.file("report.html");
        let waits = vec![r#"{"type":"wait","seconds":1}"#; (4 << 20) / 28 - 10].join(",");
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                "motions": [{waits}] }}"#
        );
        let refused = address.load(&json!({ "name": "waits.json", "text": text }));
        assert!(refused.unwrap_err().contains("has 149786 motions"));
        // Texts that were read wait in memory: 245 MB were measured on a machine that delayed the
        // threads, and less than 200 MB on an idle one.
        twin.interrupt_below(2 * MEMORY_MB);
    });
}

#[test]
fn a_drive_needs_enough_open_files_and_stops_with_them() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        let ended = rig.begin_drive_in("ulimit -n 32").end();
        assert!(!ended.status.success());
        assert!(ended.stderr.contains("needs at least 192"), "{}", ended.stderr);

        rig.start_cabinet(&[]);
        rig.drive = Some(rig.begin_drive_in("ulimit -n 192"));
        rig.wait_until_ready(&[]);
        // More connections than the drive may have files, at both ports.
        let ports = [&rig.instructions, &rig.stream];
        let silent: Vec<_> = (0..400).map(|i| TcpStream::connect(ports[i % 2]).unwrap()).collect();
        rig.iiwasim("stop", &[]).success();
        drop(silent);
    });
}
