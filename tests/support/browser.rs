//! A simulated phone: a page of a phone's size in a headless browser, controlled by the DevTools protocol.
//!
//! Each page has a separate browser. If a browser has several pages, only the newest is in the foreground, and browsers
//! pause `requestAnimationFrame` in background pages.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

use mariana_testing::process::{LOOK_PERIOD, Process, WAIT_LIMIT, private_folder, session_environment};

/// Distributions package headless Chromium under these names.
const PROGRAMS: [&str; 4] = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"];
/// Width and height of a phone's window, in CSS pixels.
pub(crate) const PHONE: (u32, u32) = (390, 844);

struct Browser {
    _process: Process,
    address: String,
    whole: String,
    _folder: TempDir,
}

impl Browser {
    fn start() -> Self {
        let folder = private_folder();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let is_there = |name: &&str| std::env::split_paths(&path).any(|folder| folder.join(name).is_file());
        let program = PROGRAMS.into_iter().find(is_there);
        let program = program.expect("Chromium not found: install the package chromium-headless-shell");
        let mut command = Command::new(program);
        command.envs(session_environment(folder.path())).args([
            "--headless",
            // Chromium has no sandbox for root. The browser opens only pages of the program under test.
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--remote-debugging-port=0",
        ]);
        command.arg(format!("--user-data-dir={}", folder.path().display())).arg("about:blank");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut process = Process::start_group(&mut command, program);
        let mut lines = BufReader::new(process.child().stderr.take().unwrap()).lines();
        let mut reported = String::new();
        let (address, whole) = loop {
            let line = lines.next().unwrap_or_else(|| panic!("{program} has ended: {reported}")).unwrap();
            if let Some(address) = line.strip_prefix("DevTools listening on ws://") {
                let (address, path) = address.trim().split_once('/').unwrap();
                break (address.to_owned(), format!("/{path}"));
            }
            reported.push_str(&line);
        };
        // Drain the pipe, so that the browser never blocks on it.
        std::thread::spawn(move || lines.count());
        Self { _process: process, address, whole, _folder: folder }
    }

    fn socket(&self, path: &str) -> WebSocket<TcpStream> {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(WAIT_LIMIT)).unwrap();
        tungstenite::client(format!("ws://{}{path}", self.address), stream).unwrap().0
    }
}

pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    number: u64,
    /// The last field, because the connection must close before the browser ends.
    browser: Browser,
}

impl Page {
    pub(crate) fn open(url: &str) -> Self {
        let browser = Browser::start();
        let mut page = Self { socket: browser.socket(&browser.whole), number: 0, browser };
        let target = page.ask("Target.createTarget", json!({ "url": "about:blank" }));
        let target = target["targetId"].as_str().unwrap().to_owned();
        page.socket = page.browser.socket(&format!("/devtools/page/{target}"));
        page.resize(PHONE);
        page.ask("Emulation.setTouchEmulationEnabled", json!({ "enabled": true, "maxTouchPoints": 5 }));
        page.go_to(url);
        page
    }

    pub(crate) fn go_to(&mut self, url: &str) {
        self.ask("Page.navigate", json!({ "url": url }));
    }

    /// Sets the size of the page's window, in CSS pixels.
    pub(crate) fn resize(&mut self, (width, height): (u32, u32)) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 2, "mobile": true });
        self.ask("Emulation.setDeviceMetricsOverride", size);
    }

    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.ask("Runtime.evaluate", asked);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// The text of the first element that matches a selector; empty if no element matches.
    pub(crate) fn text(&mut self, selector: &str) -> String {
        let text = self.value(&format!("document.querySelector({})?.textContent", json!(selector)));
        text.as_str().unwrap_or_default().to_owned()
    }

    pub(crate) fn wait_until(&mut self, what: &str, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != json!(true) {
            if start.elapsed() > WAIT_LIMIT {
                let state = self.value("typeof show === 'undefined' ? null : show");
                panic!("timed out waiting for {what}: '{}' {state}", self.text("body p"));
            }
            std::thread::sleep(LOOK_PERIOD);
        }
    }

    pub(crate) fn wait_for_text(&mut self, selector: &str, wanted: &str) {
        let (selector, text) = (json!(selector), json!(wanted));
        self.wait_until(wanted, &format!("document.querySelector({selector})?.textContent === {text}"));
    }

    /// Touches an element at the fraction `from` of its width, moves the finger to the fraction `to` along the
    /// element's middle line, and lifts the finger.
    pub(crate) fn drag(&mut self, selector: &str, from: f64, to: f64) {
        let (place, width) = self.bring_into_view(selector);
        let at = |fraction: f64| (place.0 + fraction * width, place.1);
        self.touch("touchStart", Some(at(from)));
        for step in 1..=4 {
            self.touch("touchMove", Some(at(from + (to - from) * f64::from(step) / 4.0)));
        }
        self.touch("touchEnd", None);
    }

    /// Touches the middle of an element, moves the finger down by `far` CSS pixels (up if negative), and lifts the
    /// finger.
    pub(crate) fn push(&mut self, selector: &str, far: f64) {
        let (place, width) = self.bring_into_view(selector);
        let at = |fraction: f64| (place.0 + 0.5 * width, place.1 + fraction * far);
        self.touch("touchStart", Some(at(0.0)));
        (1..=8).for_each(|step| self.touch("touchMove", Some(at(f64::from(step) / 8.0))));
        self.touch("touchMove", Some(at(1.0)));
        self.touch("touchEnd", None);
    }

    pub(crate) fn tap(&mut self, selector: &str) {
        let (place, width) = self.bring_into_view(selector);
        self.touch("touchStart", Some((place.0 + 0.5 * width, place.1)));
        self.touch("touchEnd", None);
    }

    pub(crate) fn picture(&mut self) -> Vec<u8> {
        let answer = self.ask("Page.captureScreenshot", json!({ "format": "png" }));
        let letters = answer["data"].as_str().unwrap().bytes().filter(|byte| *byte != b'=');
        let six_bits = |letter| match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let (mut bytes, mut rest, mut bits) = (Vec::new(), 0_u32, 0);
        for letter in letters {
            (rest, bits) = (rest << 6 | u32::from(six_bits(letter)), bits + 6);
            if bits >= 8 {
                bits -= 8;
                bytes.push((rest >> bits) as u8);
            }
        }
        bytes
    }

    /// Scrolls an element into view and waits until scrolling ends. Returns the middle of the element's left edge, and
    /// the element's width.
    fn bring_into_view(&mut self, selector: &str) -> ((f64, f64), f64) {
        let name = json!(selector);
        let place = self.value(&format!(
            "(async () => {{ const e = document.querySelector({name}); if (!e) return null; \
             const picture = () => new Promise(requestAnimationFrame); let at; \
             do {{ e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); at = scrollY; await picture(); \
             await picture(); }} while (scrollY !== at); const b = e.getBoundingClientRect(); \
             return [b.left, b.top + b.height / 2, b.width]; }})()"
        ));
        let number =
            |at: usize| place[at].as_f64().unwrap_or_else(|| panic!("no element matches {selector}"));
        ((number(0), number(1)), number(2))
    }

    fn touch(&mut self, kind: &str, at: Option<(f64, f64)>) {
        let points: Vec<Value> = at.iter().map(|(x, y)| json!({ "x": x, "y": y })).collect();
        self.ask("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }));
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let message = json!({ "id": self.number, "method": method, "params": params });
        self.socket.send(Message::text(message.to_string())).unwrap();
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < WAIT_LIMIT + Duration::from_secs(1), "no answer to {method}");
            let Message::Text(text) = self.socket.read().unwrap() else { continue };
            let mut answer: Value = serde_json::from_str(&text).unwrap();
            if answer["id"] == json!(self.number) {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].take();
            }
        }
    }
}
