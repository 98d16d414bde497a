//! The server as its enemies and its page meet it: over a socket.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::time::Duration;

use koiter::Vec3;
use koiter::io::result::{Field, FolderLock, Frame, Hand, Manifest, Part, PartKind, ResultWriter};
use serde_json::Value;

use super::guard::Guard;
use super::page::Page;
use super::routes::Site;
use super::server;
use super::shown::Shown;

struct Served {
    folder: tempfile::TempDir,
    port: u16,
    token: String,
}

fn manifest() -> Manifest {
    let part = |name: &str, kind, vertices, faces| Part {
        name: name.to_owned(),
        kind,
        thickness: 0.0,
        vertices,
        faces,
        solid: None,
    };
    Manifest {
        title: "Two triangles".to_owned(),
        scene_text: "title = \"x\"".to_owned(),
        parts: vec![
            part("cloth", PartKind::Shell, 0..3, 0..1),
            part("floor", PartKind::Obstacle, 3..6, 1..2),
        ],
        ..Manifest::default()
    }
}

fn frame(step: u64) -> Frame {
    let at = step as f64;
    Frame {
        step,
        time: 0.5 * at,
        positions: (0..6).map(|k| Vec3::new(f64::from(k), at, 0.0)).collect(),
        face_fields: vec![Field {
            name: "strain".to_owned(),
            values: vec![at as f32, 100.0],
        }],
        ..Frame::default()
    }
}

fn write(folder: &Path, frames: u64) -> ResultWriter {
    let mut writer = ResultWriter::create(folder, &manifest(), &[[0, 1, 2], [3, 4, 5]]).unwrap();
    (0..frames).for_each(|step| writer.write_frame(&frame(step)).unwrap());
    writer
}

impl Served {
    /// A result of three frames, behind a server of its own.
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let result = folder.path().join("result");
        drop(write(&result, 3));
        std::fs::write(folder.path().join("secret.txt"), "secret").unwrap();
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let guard = Guard::new(port);
        let token = guard.token.clone();
        let site = Site {
            guard,
            page: Page::STUB,
            results: vec![Shown::open(&result).unwrap()],
        };
        std::thread::spawn(move || server::serve(&listener, move |r| site.answer(r)));
        Self {
            folder,
            port,
            token,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(20)))
            .unwrap();
        stream
    }

    /// Status and body of the answer to these bytes; nothing where the connection was cut.
    fn try_send(&self, bytes: &[u8]) -> Option<(u16, Vec<u8>)> {
        let mut stream = self.connect();
        stream.write_all(bytes).ok()?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).ok()?;
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n")?;
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let status = head[9..12].parse().unwrap();
        Some((status, answer[end + 4..].to_vec()))
    }

    fn send(&self, bytes: &[u8]) -> (u16, Vec<u8>) {
        self.try_send(bytes).expect("an answer")
    }

    fn get_with(&self, path: &str, headers: &str) -> (u16, Vec<u8>) {
        let port = self.port;
        let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{headers}\r\n");
        self.send(request.as_bytes())
    }

    fn get(&self, path: &str) -> (u16, Vec<u8>) {
        self.get_with(path, "")
    }

    fn json(&self, path: &str) -> Value {
        let (status, body) = self.get(path);
        assert_eq!(status, 200, "{path}: {}", String::from_utf8_lossy(&body));
        serde_json::from_slice(&body).unwrap()
    }

    fn ask(&self, word: &str, token: &str) -> u16 {
        self.post("request", word, token)
    }

    fn post(&self, what: &str, word: &str, token: &str) -> u16 {
        let (port, length) = (self.port, word.len());
        let request = format!(
            "POST /api/results/0/{what} HTTP/1.1\r\nHost: localhost:{port}\r\nX-Koiter-Token: {token}\r\n\
             Content-Length: {length}\r\n\r\n{word}"
        );
        self.send(request.as_bytes()).0
    }
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    let (values, _) = bytes.as_chunks::<4>();
    values
        .iter()
        .map(|&value| f32::from_le_bytes(value))
        .collect()
}

#[test]
fn the_page_gets_what_a_result_consists_of() {
    let served = Served::new();
    let page = String::from_utf8(served.get("/").1).unwrap();
    assert!(page.contains(&served.token));
    assert_eq!(served.get("/viewer.js"), (200, b"'script'".to_vec()));
    let results = served.json("/api/results");
    assert_eq!(results[0]["title"], "Two triangles");
    assert_eq!(results[0]["fields"][0]["name"], "strain");
    assert_eq!(results[0]["parts"][1]["kind"], "obstacle");
    let state = served.json("/api/results/0/state");
    assert_eq!(state["times"], serde_json::json!([0.0, 0.5, 1.0]));
    assert_eq!(
        (&state["ended"], &state["generation"]),
        (&false.into(), &0.into())
    );
    assert_eq!(served.get("/api/results/0/topology").1.len(), 24);
    let positions = floats(&served.get("/api/results/0/frames/2").1);
    assert_eq!(
        (positions.len(), &positions[..3]),
        (18, &[0.0, 2.0, 0.0][..])
    );
    let with_field = floats(&served.get("/api/results/0/frames/2?field=0").1);
    assert_eq!(with_field[18..], [2.0, 100.0]);
    // The obstacle's 100 does not count.
    assert_eq!(served.json("/api/results/0/range?field=0")["high"], 1.0);
    let history = served.json("/api/results/0/history?vertex=1");
    assert_eq!(history["y"], serde_json::json!([0.0, 1.0, 2.0]));
    let history = served.json("/api/results/0/history?face=0");
    assert_eq!(history["strain"], serde_json::json!([0.0, 1.0, 2.0]));
    assert_eq!(served.get("/api/results/0/scene").1, b"title = \"x\"");
}

#[test]
fn nothing_outside_the_result_is_reached() {
    let served = Served::new();
    for path in [
        "/../secret.txt",
        "/..%2fsecret.txt",
        "/api/results/0/../../../secret.txt",
        "/api/results/0/frames/../../../secret.txt",
        "/api/results/0/frames/%2e%2e%2fmanifest.json",
        "/api/results/0/frames/-1",
        "/api/results/0/frames/+1",
        "/api/results/1/state",
        "/api/results/0/manifest.json",
        "//api/results",
        "/viewer.js/",
        "http://127.0.0.1/secret.txt",
        "/etc/passwd",
    ] {
        let (status, body) = served.get(path);
        assert_eq!(status, 404, "{path}: {}", String::from_utf8_lossy(&body));
    }
    for path in [
        "/api/results/0/frames/3",
        "/api/results/0/frames/999999999999999",
        "/api/results/0/frames/1?field=7",
        "/api/results/0/history?vertex=6",
        "/api/results/0/history?face=99999999999999",
    ] {
        assert_eq!(served.get(path).0, 500, "{path}");
    }
}

#[test]
fn other_hosts_and_other_pages_are_refused() {
    let served = Served::new();
    let port = served.port;
    let with_host = |host: &str| {
        let request = format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n");
        served.send(request.as_bytes()).0
    };
    assert_eq!(with_host(&format!("localhost:{port}")), 200);
    assert_eq!(with_host(&format!("rebound.example:{port}")), 403);
    assert_eq!(with_host("127.0.0.1"), 403);
    assert_eq!(served.send(b"GET / HTTP/1.0\r\n\r\n").0, 403);
    let own = format!("Origin: http://127.0.0.1:{port}\r\nSec-Fetch-Site: same-origin\r\n");
    assert_eq!(served.get_with("/api/results", &own).0, 200);
    assert_eq!(
        served
            .get_with("/api/results", "Origin: https://evil.example\r\n")
            .0,
        403
    );
    assert_eq!(served.get_with("/api/results", "Origin: null\r\n").0, 403);
    assert_eq!(
        served.get_with("/", "Sec-Fetch-Site: cross-site\r\n").0,
        403
    );
}

#[test]
fn a_run_is_asked_only_with_the_token_and_only_while_it_goes_on() {
    let served = Served::new();
    let result = served.folder.path().join("result");
    let request = result.join("request.txt");
    assert_eq!(served.ask("stop", "wrong"), 403);
    assert_eq!(
        served.ask("stop", &served.token),
        409,
        "no run is there to stop"
    );
    let lock = FolderLock::take(&result).unwrap();
    assert_eq!(served.json("/api/results/0/state")["running"], true);
    assert_eq!(served.ask("dance", &served.token), 409);
    assert!(!request.exists());
    assert_eq!(served.ask("pause", &served.token), 200);
    assert_eq!(std::fs::read(&request).unwrap(), b"pause\n");
    assert_eq!(served.json("/api/results/0/state")["request"], "pause");
    assert_eq!(served.ask("continue", &served.token), 200);
    assert!(!request.exists());
    assert_eq!(served.get("/api/results/0/request").0, 404);
    drop(lock);
    assert_eq!(served.json("/api/results/0/state")["running"], false);
}

#[test]
fn a_hand_pulls_only_with_the_token_and_only_where_a_run_waits_for_it() {
    let served = Served::new();
    let result = served.folder.path().join("result");
    let pull = |line: &str| served.post("hand", line, &served.token);
    let target = Vec3::new(0.1, 0.25, -2e-3);
    assert_eq!(pull("2 0.1 0.25 -2e-3"), 409, "no run waits");
    assert_eq!(served.json("/api/results/0/state")["playable"], false);
    let lock = FolderLock::take(&result).unwrap();
    Hand::Released.write(&result).unwrap();
    assert_eq!(served.json("/api/results/0/state")["playable"], true);
    assert_eq!(served.post("hand", "2 0 0 0", "wrong"), 403);
    for line in ["", "2 0 0", "2 0 0 nan", "../x 0 0 0", "released now"] {
        assert_eq!(pull(line), 409, "{line}");
    }
    assert_eq!(pull(&format!("2 {}", "0".repeat(200))), 413);
    assert_eq!(Hand::read(&result), Some(Hand::Released));
    assert_eq!(pull("2 0.1 0.25 -2e-3"), 200);
    assert_eq!(Hand::read(&result), Some(Hand::Pulls { vertex: 2, target }));
    assert_eq!(pull("released"), 200);
    assert_eq!(Hand::read(&result), Some(Hand::Released));
    drop(lock);
    assert_eq!(served.json("/api/results/0/state")["playable"], false);
}

#[test]
fn a_run_is_followed_and_a_new_one_in_its_place_is_noticed() {
    let served = Served::new();
    let result = served.folder.path().join("result");
    assert_eq!(
        served.json("/api/results/0/state")["times"]
            .as_array()
            .unwrap()
            .len(),
        3
    );
    let more = koiter::io::write_atomically;
    let bytes = std::fs::read(result.join("frames/00002.bin")).unwrap();
    more(&result.join("frames/00003.bin"), &bytes).unwrap();
    assert_eq!(
        served.json("/api/results/0/state")["times"]
            .as_array()
            .unwrap()
            .len(),
        4
    );
    // Times of files are told apart from milliseconds on.
    std::thread::sleep(Duration::from_millis(30));
    drop(write(&result, 1));
    let state = served.json("/api/results/0/state");
    assert_eq!(
        (&state["generation"], &state["times"]),
        (&1.into(), &serde_json::json!([0.0]))
    );
}

#[test]
fn a_damaged_frame_is_told_and_the_others_are_shown() {
    let served = Served::new();
    let frame = served.folder.path().join("result/frames/00001.bin");
    std::fs::write(&frame, b"nonsense").unwrap();
    let (status, body) = served.get("/api/results/0/frames/1");
    let message = String::from_utf8(body).unwrap();
    assert!(
        status == 500 && message.contains("00001.bin is broken"),
        "{message}"
    );
    assert_eq!(served.get("/api/results/0/frames/2").0, 200);
    std::fs::remove_file(&frame).unwrap();
    assert_eq!(
        served.json("/api/results/0/state")["times"]
            .as_array()
            .unwrap()
            .len(),
        3
    );
    assert_eq!(served.get("/api/results/0/frames/1").0, 500);
}

#[test]
fn garbage_and_long_headers_are_refused_with_a_reason() {
    let served = Served::new();
    assert_eq!(served.send(b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n").0, 400);
    assert_eq!(served.send(b"\xff\xfe\r\n\r\n").0, 400);
    assert_eq!(served.send(b"PUT / HTTP/1.1\r\n\r\n").0, 405);
    assert_eq!(served.send(&b"A".repeat(40_000)).0, 431);
    let long = format!(
        "POST / HTTP/1.1\r\nContent-Length: 100000\r\n\r\n{}",
        "x".repeat(100_000)
    );
    assert_eq!(served.send(long.as_bytes()).0, 413);
    assert_eq!(served.get("/").0, 200);
}

#[test]
fn a_flood_of_connections_is_turned_away_and_passes() {
    let served = Served::new();
    // They say nothing and take all places.
    let idle: Vec<TcpStream> = (0..100).map(|_| served.connect()).collect();
    let mut turned_away = 0;
    for mut stream in &idle {
        stream
            .set_read_timeout(Some(Duration::from_millis(20)))
            .unwrap();
        let mut start = [0; 12];
        let told = stream.read_exact(&mut start).is_ok();
        turned_away += usize::from(told && &start == b"HTTP/1.1 503");
    }
    assert!((50..=80).contains(&turned_away), "{turned_away} of 100");
    drop(idle);
    // Those who hold a place have gone: it is free again.
    let answered = (0..100).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        let request = format!("GET / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", served.port);
        let answer = served.try_send(request.as_bytes());
        answer.is_some_and(|(status, _)| status == 200)
    });
    assert!(answered);
}
