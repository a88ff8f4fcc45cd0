//! `monitor`: what a browser gets from a run folder, finished, growing, damaged or hostile; and who gets nothing.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, ChildStdout};
use std::time::Duration;

use rustix::fs::{CWD, FileType, Mode, mknodat};

use super::evolve::{copy_of_finished, finished};
use super::workshop::Workshop;

/// A monitor of the folder `out` of a workshop; stopped when dropped.
struct Monitor {
    child: Child,
    address: SocketAddr,
    /// Kept open: who prints into a closed pipe is told.
    _out: BufReader<ChildStdout>,
}

/// What the server answered.
struct Response {
    status: u16,
    head: String,
    body: String,
}

impl Response {
    fn json(&self) -> serde_json::Value {
        assert_eq!(self.status, 200, "{}", self.body);
        serde_json::from_str(&self.body).unwrap()
    }

    fn header(&self, name: &str) -> &str {
        let lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines.into_iter().find(|line| line.0.eq_ignore_ascii_case(name)).unwrap().1
    }
}

impl Monitor {
    fn of(workshop: &Workshop) -> Self {
        let mut child = workshop.command(&["monitor", "out", "--port", "0"]).spawn().unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        out.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap().trim_end_matches('/');
        Self { child, address: address.parse().unwrap(), _out: out }
    }

    fn get(&self, path: &str) -> Response {
        self.get_with(path, &format!("Host: {}\r\n", self.address))
    }

    fn get_with(&self, path: &str, headers: &str) -> Response {
        let mut stream = TcpStream::connect(self.address).unwrap();
        // No answer takes longer than the computation of one small design.
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let request = format!("GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Response { status, head: head.to_owned(), body: body.to_owned() }
    }
}

impl Drop for Monitor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn length(value: &serde_json::Value) -> usize {
    value.as_array().unwrap().len()
}

#[test]
fn the_run_is_shown_as_its_files_have_it() {
    let workshop = finished();
    let monitor = Monitor::of(workshop);
    let run = monitor.get("/api/run").json();
    assert_eq!([&run["state"], &run["name"]], ["finished", "out"]);
    assert_eq!([&run["generation"], &run["generations"], &run["evaluated"]], [3, 3, 18]);
    assert_eq!(run["material"], "ninjaflex-c2s");
    assert_eq!(run["warnings"], serde_json::json!([]));
    assert_eq!(length(&run["history"]), 3);
    let hypervolumes: Vec<f64> = run["history"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["hypervolume"].as_f64().unwrap())
        .collect();
    assert_eq!(hypervolumes, workshop.column("out/history.csv", "hypervolume"));
    let front: Vec<&str> =
        run["front"].as_array().unwrap().iter().map(|id| id.as_str().unwrap()).collect();
    let mut table: Vec<String> = workshop
        .read("out/front.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().to_owned())
        .collect();
    table.sort_by_key(|id| front.iter().position(|member| member == id));
    assert_eq!(front, table);
    let counted: u64 = run["outcomes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["candidates"].as_u64().unwrap())
        .sum();
    assert_eq!(counted, 18);
    // Each new genome was evaluated somewhere.
    assert_eq!(run["ranks"][0]["rank"], 0);
    assert!(run["ranks"][0]["per_hour"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_design_is_shown_with_its_path() {
    let workshop = finished();
    let monitor = Monitor::of(workshop);
    let run = monitor.get("/api/run").json();
    let id = run["front"][0].as_str().unwrap();
    let design = monitor.get(&format!("/api/design/{id}")).json();
    assert_eq!([&design["id"], &design["status"]], [id, "evaluated"]);
    let point =
        run["candidates"].as_array().unwrap().iter().find(|point| point["id"] == id).unwrap();
    assert_eq!(design["evaluation"]["bending"], point["bending"]);
    assert_eq!(length(&design["genome"]), 22);
    let shape = monitor.get(&format!("/api/shape/{id}")).json();
    let vertices = length(&shape["reference"]) / 3;
    let bending = &shape["scenarios"][0];
    let angles = workshop.column(&format!("out/front/{id}/path.csv"), "angle_deg");
    assert_eq!(length(&bending["rows"]), angles.len());
    assert_eq!(length(&bending["frames"]), angles.len());
    for (row, angle) in bending["rows"].as_array().unwrap().iter().zip(&angles) {
        assert_eq!(row["angle_deg"].as_f64(), Some(*angle));
    }
    for scenario in shape["scenarios"].as_array().unwrap() {
        for frame in scenario["frames"].as_array().unwrap() {
            assert_eq!(length(&frame["positions"]), 3 * vertices);
            assert_eq!([length(&frame["stretch"]), length(&frame["stress"])], [vertices; 2]);
        }
        // Nothing is stretched at rest.
        let stretches = scenario["frames"][0]["stretch"].as_array().unwrap();
        assert!(stretches.iter().all(|stretch| stretch == 1.0));
    }
}

#[test]
fn what_is_not_there_is_refused_in_one_line() {
    let monitor = Monitor::of(finished());
    let run = monitor.get("/api/run").json();
    for path in ["/api/design/g999-999", "/api/shape/nonsense", "/api/design/..%2F..%2Frun.toml"] {
        let refused = monitor.get(path);
        assert_eq!(refused.status, 404, "{path}");
        let words: serde_json::Value = serde_json::from_str(&refused.body).unwrap();
        assert_eq!(words["error"].as_str().unwrap().lines().count(), 1);
    }
    for path in ["/run.toml", "/../run.toml", "/..%2frun.toml", "/%2e%2e/run.toml", "/api/other"] {
        assert_eq!(monitor.get(path).status, 404, "{path}");
    }
    let evaluated = run["candidates"].as_array().unwrap();
    let rejected = (0..6).map(|k| format!("g000-00{k}"));
    let mut rejected = rejected.filter(|id| evaluated.iter().all(|point| point["id"] != **id));
    let refused = monitor.get(&format!("/api/shape/{}", rejected.next().unwrap()));
    assert_eq!(refused.status, 422, "{}", refused.body);
}

/// DNS rebinding and the pages of other sites: what names another host, or comes from another site, gets nothing.
#[test]
fn only_this_machine_is_answered() {
    let monitor = Monitor::of(finished());
    let port = monitor.address.port();
    for (headers, status) in [
        (format!("Host: localhost:{port}\r\n"), 200),
        (format!("Host: example.org:{port}\r\n"), 403),
        (format!("Host: 192.168.1.9:{port}\r\n"), 403),
        (format!("Host: localhost:{port}\r\nSec-Fetch-Site: cross-site\r\n"), 403),
        (format!("Host: localhost:{port}\r\nSec-Fetch-Site: same-origin\r\n"), 200),
    ] {
        let response = monitor.get_with("/api/run", &headers);
        assert_eq!(response.status, status, "{headers}");
        assert!(response.header("content-security-policy").starts_with("default-src 'self'"));
    }
    assert!(monitor.address.ip().is_loopback());
}

#[test]
fn what_is_known_is_not_sent_again() {
    let monitor = Monitor::of(finished());
    let host = format!("Host: {}\r\n", monitor.address);
    let first = monitor.get("/api/run");
    let tag = first.header("etag");
    let again = monitor.get_with("/api/run", &format!("{host}If-None-Match: {tag}\r\n"));
    assert_eq!((again.status, again.body.as_str()), (304, ""));
}

/// A folder as a run leaves it between two generations, and in the middle of one: the third is under way.
#[test]
fn a_run_that_goes_on_is_shown_as_far_as_it_is() {
    let workshop = copy_of_finished();
    let log = workshop.read("out/candidates.jsonl");
    let lines: Vec<&str> = log.lines().collect();
    workshop.write("out/candidates.jsonl", lines[..12].join("\n") + "\n");
    // The last line is being written.
    workshop
        .write("out/running.jsonl", format!("{}\n{}\n{}", lines[12], lines[13], &lines[14][..40]));
    std::fs::remove_file(workshop.path("out/checkpoints/checkpoint-000003.json")).unwrap();
    let monitor = Monitor::of(&workshop);
    let run = monitor.get("/api/run").json();
    assert_eq!(run["state"], "running");
    assert_eq!([&run["generation"], &run["evaluated"], &run["in_generation"]], [2, 14, 2]);
    assert!(run["seconds_left"].as_f64().unwrap() > 0.0);
    assert_eq!(run["warnings"], serde_json::json!([]));
    // One more ends while somebody looks.
    workshop.write("out/running.jsonl", lines[12..15].join("\n") + "\n");
    assert_eq!(monitor.get("/api/run").json()["in_generation"], 3);
}

#[test]
fn a_hostile_folder_does_no_harm() {
    let workshop = copy_of_finished();
    let markup = "<img src=x onerror=alert(1)>";
    // Without checksums, as earlier versions wrote it: a line of the same meaning is let in.
    let log: String = (workshop.read("out/candidates.jsonl").lines())
        .map(|line| line.split(",\"checksum\"").next().unwrap().to_owned() + "}\n")
        .collect();
    let hostile = log.replace("\"islands\"", &format!("\"{markup}\""));
    let lines = "{\"id\":\"../../etc/passwd\"}\nnot JSON at all\n";
    workshop.write("out/candidates.jsonl", format!("{hostile}{lines}"));
    let monitor = Monitor::of(&workshop);
    let response = monitor.get("/api/run");
    assert_eq!(response.header("content-type"), "application/json");
    assert_eq!(response.header("x-content-type-options"), "nosniff");
    let run = response.json();
    assert_eq!(run["evaluated"], 18);
    assert_eq!(run["warnings"], serde_json::json!(["2 damaged lines of candidates are left out"]));
    // A file that would not fit in memory, of holes alone, is refused before it is read.
    let log =
        std::fs::File::options().write(true).open(workshop.path("out/candidates.jsonl")).unwrap();
    log.set_len(1 << 40).unwrap();
    let refused = monitor.get("/api/run");
    assert_eq!(refused.status, 500);
    assert!(refused.body.contains("candidates.jsonl is too large"), "{}", refused.body);
    // So is a run file that is none.
    drop(log);
    workshop.write("out/candidates.jsonl", "");
    workshop.write("out/run.toml", "[evolution]\npopulation = \"many\"\n");
    assert_eq!(monitor.get("/api/run").status, 500);
}

#[test]
fn wrong_folders_and_taken_ports_are_refused() {
    let workshop = Workshop::new();
    workshop.refuse(&["monitor", "nowhere"], 1, &["nowhere"]);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    finished().refuse(&["monitor", "out", "--port", &port], 1, &["--port", &port]);
}

/// A pipe that nobody writes to blocks who opens it: it is named instead, and the run is shown again when it is gone.
#[test]
fn a_pipe_in_the_folder_is_no_trap() {
    let workshop = copy_of_finished();
    let monitor = Monitor::of(&workshop);
    for name in ["running.jsonl", "checkpoints/99999999", "provenance.json", "front_solid.csv"] {
        let path = workshop.path("out").join(name);
        let kept = std::fs::read(&path).ok();
        let _ = std::fs::remove_file(&path);
        mknodat(CWD, &path, FileType::Fifo, Mode::RWXU, 0).unwrap();
        // Twice, as a page does, and of a design too.
        for question in ["/api/run", "/api/run", "/api/design/g000-000"] {
            let answer = monitor.get(question);
            assert!([200, 500].contains(&answer.status), "{name}: {}", answer.body);
        }
        std::fs::remove_file(&path).unwrap();
        if let Some(kept) = kept {
            std::fs::write(&path, kept).unwrap();
        }
        assert_eq!(monitor.get("/api/run").status, 200, "{name}");
    }
}

/// Whoever sends half a request keeps no place for ever: all places taken so are free again after 15 seconds.
#[test]
fn half_sent_requests_are_closed() {
    let workshop = finished();
    let monitor = Monitor::of(workshop);
    let half = |_| {
        let mut stream = TcpStream::connect(monitor.address).unwrap();
        stream.write_all(b"GET /api/run HTTP/1.1\r\nHost: local").unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    };
    let halves: Vec<TcpStream> = (0..64).map(half).collect();
    assert_eq!(monitor.get("/api/run").status, 200);
    for mut stream in halves {
        // The end, or a word that it took too long, and then the end.
        let _ = stream.read_to_end(&mut Vec::new());
    }
}
