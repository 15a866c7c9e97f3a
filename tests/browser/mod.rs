//! Headless Chromium, driven by its own driver over HTTP and JSON (W3C WebDriver).
// Each test file uses its part of this.
#![allow(dead_code)]

pub mod shown;

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;
use tempfile::TempDir;

/// Keys by the code points that WebDriver gives them.
pub const ARROW_RIGHT: &str = "\u{e014}";
pub const ARROW_DOWN: &str = "\u{e015}";
pub const ENTER: &str = "\u{e007}";

/// What makes Chromium keep to itself.
const ARGUMENTS: [&str; 9] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
];

/// A browser with an empty profile; gone when it is dropped.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    folder: TempDir,
}

impl Browser {
    /// Starts one; says so aloud if there is none on this machine.
    pub fn start() -> Option<Self> {
        let (Some(driver), Some(chromium)) = (found("chromedriver"), found("chromium")) else {
            let mut out = std::io::stderr();
            writeln!(out, "SKIPPED: there is no chromium with chromedriver").unwrap();
            return None;
        };
        let (driver, port) = start_driver(&driver);
        let profile = tempfile::tempdir().unwrap();
        let mut browser = Self {
            driver,
            port,
            session: String::new(),
            folder: profile,
        };
        browser.open_session(&chromium);
        Some(browser)
    }

    fn open_session(&mut self, chromium: &Path) {
        let mut arguments: Vec<String> = ARGUMENTS.map(str::to_owned).into();
        arguments.push(format!(
            "--user-data-dir={}",
            self.folder.path().join("profile").display()
        ));
        let asked = json!({ "capabilities": { "alwaysMatch": {
            "goog:loggingPrefs": { "browser": "ALL" },
            "goog:chromeOptions": { "binary": chromium, "args": arguments },
        } } });
        let opened = self.ask("POST", "/session", Some(asked));
        let id = opened["sessionId"].as_str().expect("a session has an id");
        self.session = format!("/session/{id}");
    }

    /// A folder that lasts as long as the browser.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Opens a file and gives the milliseconds until everything of it was there.
    pub fn open(&self, file: &Path) -> f64 {
        self.post(
            "/url",
            json!({ "url": format!("file://{}", file.display()) }),
        );
        let took = "return performance.getEntriesByType('navigation')[0].loadEventEnd";
        let start = Instant::now();
        loop {
            let ms = self.run(took).as_f64().unwrap();
            if ms > 0.0 {
                return ms;
            }
            assert!(start.elapsed().as_secs() < 60, "the page does not load");
        }
    }

    /// Runs the body of a function in the page and gives what it returns.
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", json!({ "script": script, "args": [] }))
    }

    /// The same for a text.
    pub fn text(&self, script: &str) -> String {
        let value = self.run(script);
        let text = value.as_str();
        text.unwrap_or_else(|| panic!("{script}: {value}"))
            .to_owned()
    }

    /// The same for a count.
    pub fn count(&self, script: &str) -> u64 {
        let value = self.run(script);
        value
            .as_u64()
            .unwrap_or_else(|| panic!("{script}: {value}"))
    }

    /// Moves the mouse to a place in the window, pixels.
    pub fn point_at(&self, x: f64, y: f64) {
        let step = json!({ "type": "pointerMove", "duration": 0, "x": x.round(), "y": y.round(), "origin": "viewport" });
        let mouse = json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": [step] });
        self.post("/actions", json!({ "actions": [mouse] }));
    }

    /// Presses a key and lets it go.
    pub fn press(&self, key: &str) {
        let steps = json!([{ "type": "keyDown", "value": key }, { "type": "keyUp", "value": key }]);
        let keyboard = json!({ "type": "key", "id": "keyboard", "actions": steps });
        self.post("/actions", json!({ "actions": [keyboard] }));
    }

    /// Clicks on the first element of a CSS selector, as a person does.
    pub fn click(&self, selector: &str) {
        self.run(&format!(
            "document.querySelector({selector:?}).scrollIntoView({{ block: 'center' }})"
        ));
        let asked = json!({ "using": "css selector", "value": selector });
        let found = self.post("/element", asked);
        let id = found
            .as_object()
            .and_then(|o| o.values().next())
            .and_then(Value::as_str);
        let id = id.expect("an element has an id");
        self.post(&format!("/element/{id}/click"), json!({}));
    }

    /// Chooses an option of the first `<select>` of a CSS selector by its text.
    pub fn choose(&self, selector: &str, option: &str) {
        let index = self.run(&format!(
            "return [...document.querySelector({selector:?}).options].findIndex((o) => o.textContent.startsWith({option:?}))"
        ));
        let index = index.as_i64().unwrap();
        assert!(index >= 0, "{selector} has no option {option}");
        self.run(&format!(
            "const s = document.querySelector({selector:?}); s.selectedIndex = {index}; s.dispatchEvent(new Event('change'))"
        ));
    }

    /// A command of the DevTools protocol.
    pub fn devtools(&self, command: &str, parameters: Value) -> Value {
        let asked = json!({ "cmd": command, "params": parameters });
        self.post("/goog/cdp/execute", asked)
    }

    /// Sets the size of the window's content, pixels.
    pub fn resize(&self, width: usize, height: usize) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.devtools("Emulation.setDeviceMetricsOverride", size);
    }

    /// Fails if the page said anything in the console or asked the network for anything.
    pub fn check_quiet(&self) {
        let said = self.post("/se/log", json!({ "type": "browser" }));
        assert_eq!(said, json!([]), "the console");
        let asked = self.run(
            "return performance.getEntriesByType('resource').map((r) => r.name).filter((n) => !n.startsWith('data:'))",
        );
        assert_eq!(asked, json!([]), "the network");
    }

    fn post(&self, path: &str, body: Value) -> Value {
        self.ask("POST", &format!("{}{path}", self.session), Some(body))
    }

    /// One request, one connection; once more where the driver hangs up, as it may on a busy machine.
    fn ask(&self, method: &str, path: &str, body: Option<Value>) -> Value {
        let body = body.map_or(String::new(), |body| body.to_string());
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
            self.port,
            body.len()
        );
        let send = || {
            let mut stream = TcpStream::connect(("127.0.0.1", self.port))?;
            stream.write_all(request.as_bytes())?;
            answer(&mut BufReader::new(stream))
        };
        let (head, body) = send().or_else(|_| send()).expect("an answer of the driver");
        let value: Value = serde_json::from_str(&body).expect("an answer in JSON");
        assert!(head.starts_with("HTTP/1.1 200"), "{method} {path}: {value}");
        value["value"].clone()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ends Chromium; a session that a failure has left half open ends with its driver.
        if !self.session.is_empty() && !std::thread::panicking() {
            self.ask("DELETE", &self.session, None);
        } else if let Ok(mut stream) = TcpStream::connect(("127.0.0.1", self.port)) {
            let head = format!(
                "DELETE {} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
                self.session
            );
            let _ = stream.write_all(head.as_bytes());
            let _ = stream.read(&mut [0; 64]);
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// Starts the driver on a port that it chooses itself (a port that we found free could be taken by the time the driver
/// binds it) and gives that port, which it prints once it listens.
fn start_driver(program: &Path) -> (Child, u16) {
    let mut driver = Command::new(program)
        .arg("--port=0")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(driver.stdout.take().unwrap()).lines();
    let started = said
        .by_ref()
        .find_map(|line| {
            Some(
                line.unwrap()
                    .split_once("successfully on port ")?
                    .1
                    .to_owned(),
            )
        })
        .expect("chromedriver listens");
    // What it says later is read and dropped, lest it wait for a full pipe.
    std::thread::spawn(move || said.count());
    (driver, started.trim_end_matches('.').parse().unwrap())
}

/// Head and body of an answer; the driver keeps its connections open, so the head says where the body ends.
fn answer(stream: &mut impl BufRead) -> std::io::Result<(String, String)> {
    let (mut head, mut length) = (String::new(), 0);
    loop {
        let mut line = String::new();
        let n = stream.read_line(&mut line)?;
        if n == 0 || line == "\r\n" {
            break;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().unwrap();
        }
        head += &line;
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((head, String::from_utf8(body).unwrap()))
}

/// Where a program is, if it is installed.
fn found(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let mut paths = std::env::split_paths(&folders).map(|folder| folder.join(name));
    paths.find(|path| path.is_file())
}
