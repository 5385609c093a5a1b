//! Chromium without a window, driven by its DevTools protocol over a pipe.
//!
//! This is all that the tests need of a browser: a dozen commands. `chromiumoxide` 0.9 is maintained and its licences fit. It would add some 65 crates to
//! be built, 6 MB of generated protocol among them, and asynchronous code to tests that wait for one answer after the other. It also needs a web socket
//! on a port; a pipe needs no free port, and no other process reaches the browser through it.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::line::{PATIENCE, root};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// It reads commands from descriptor 3 and answers on 4; a process is given its first two.
const START: &str = "exec chromium \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>/dev/null";

/// Tests run as root as well, where Chromium has no sandbox.
const OPTIONS: [&str; 8] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--no-first-run",
    "--disable-background-networking",
    "--remote-debugging-pipe",
];

/// The checks of a page, as one expression without the comment above it.
fn access() -> &'static str {
    let script = include_str!("access.js");
    script[script.find("(() =>").unwrap()..].trim_end()
}

/// Where `make test-packages` puts axe-core, from the root of the workspace.
const AXE_FILE: &str = "target/axe/axe.min.js";

/// What axe-core finds, in its words.
const AXE: &str = "axe.run().then(({ violations }) => violations.map(({ id, nodes }) => `axe: ${id}: ${nodes.map(({ html }) => html)}`))";

/// What is wrong with where the focus is: `null` where nothing is.
const FOCUS: &str = "
(() => {
    const [before, now] = [window.focused, document.activeElement];
    window.focused = now;
    const { outlineStyle, outlineWidth } = getComputedStyle(now);
    if (now === document.body || !now.checkVisibility()) return 'the focus is nowhere';
    if (outlineStyle === 'none' || parseFloat(outlineWidth) < 2) return `nobody sees that this has the focus: ${now.outerHTML}`;
    const goesOn = !before?.isConnected || before.compareDocumentPosition(now) & Node.DOCUMENT_POSITION_FOLLOWING;
    return goesOn ? null : `the focus goes back to ${now.outerHTML}`;
})()";

fn texts(value: Value) -> Vec<String> {
    serde_json::from_value(value).unwrap()
}

/// A browser. It is killed when this is dropped.
pub struct Browser {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// The number of the newest command.
    number: u64,
    _profile: TempDir,
}

/// A page that is open.
pub struct Tab(String);

impl Browser {
    /// Starts one with a profile of its own.
    pub fn start() -> Self {
        Self::start_with(&[])
    }

    /// Starts one with further options of Chromium.
    pub fn start_with(options: &[&str]) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let mut child = Command::new("sh")
            .args(["-c", START, "sh"])
            .args(OPTIONS)
            .args(options)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            // One that is killed leaves what it has made there.
            .env("TMPDIR", profile.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (commands, answers) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        Self { child, commands, answers: BufReader::new(answers), number: 0, _profile: profile }
    }

    /// Opens a page in a window of its own, of this size: one in the background would rest.
    pub fn open(&mut self, address: &str, [width, height]: [u32; 2]) -> Tab {
        let target = self.ask(None, "Target.createTarget", json!({"url": "about:blank", "newWindow": true}));
        let session = json!({"targetId": target["targetId"], "flatten": true});
        let session = self.ask(None, "Target.attachToTarget", session);
        let tab = Tab(session["sessionId"].as_str().unwrap().to_owned());
        self.ask(Some(&tab), "Page.enable", json!({}));
        self.resize(&tab, [width, height]);
        self.go(&tab, address);
        tab
    }

    /// Lets nothing through of what ends with one of these, and nothing comes from the cache.
    pub fn block(&mut self, tab: &Tab, ends: &[&str]) {
        let urls: Vec<_> = ends.iter().map(|end| format!("*{end}")).collect();
        self.ask(Some(tab), "Network.enable", json!({}));
        self.ask(Some(tab), "Network.setCacheDisabled", json!({"cacheDisabled": true}));
        self.ask(Some(tab), "Network.setBlockedURLs", json!({"urls": urls}));
    }

    /// Makes the window this large. A small one that is higher than wide is a tablet, which people touch.
    pub fn resize(&mut self, tab: &Tab, [width, height]: [u32; 2]) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.ask(Some(tab), "Emulation.setDeviceMetricsOverride", size);
        let is_touched = json!({"enabled": width < 1000 && height > width});
        self.ask(Some(tab), "Emulation.setTouchEmulationEnabled", is_touched);
    }

    /// Goes to another page and waits until it is there.
    pub fn go(&mut self, tab: &Tab, address: &str) {
        self.ask(Some(tab), "Page.navigate", json!({"url": address}));
        self.until(tab, "document.readyState === 'complete' && location.href !== 'about:blank'");
    }

    /// Presses a key that writes nothing, as Tab, or Enter or the space bar, which do what has the focus.
    pub fn press(&mut self, tab: &Tab, key: &str, code: u32) {
        // These two do nothing without their character.
        let text = match key {
            "Enter" => "\r",
            " " => " ",
            _ => "",
        };
        for kind in [if text.is_empty() { "rawKeyDown" } else { "keyDown" }, "keyUp"] {
            let event =
                json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code, "text": text});
            self.ask(Some(tab), "Input.dispatchKeyEvent", event);
        }
    }

    /// Logs in by the form that is shown.
    pub fn log_in(&mut self, tab: &Tab, name: &str, password: &str) {
        self.until(tab, "document.getElementById('password') !== null");
        let fill = format!(
            "document.getElementById('name').value = {};
             document.getElementById('password').value = {};
             document.querySelector('form.login').requestSubmit();
             true",
            json!(name),
            json!(password)
        );
        assert_eq!(self.value(tab, &fill), json!(true));
    }

    /// Keeps a picture of a page in the folder `ANDON_SCREENSHOTS`, if somebody asks for it, to be looked at.
    pub fn keep(&mut self, tab: &Tab, name: &str) {
        let Some(folder) = std::env::var_os("ANDON_SCREENSHOTS") else { return };
        let picture = self.picture(tab);
        std::fs::write(std::path::Path::new(&folder).join(format!("{name}.b64")), picture).unwrap();
    }

    /// Writes where the focus is.
    pub fn write(&mut self, tab: &Tab, text: &str) {
        self.ask(Some(tab), "Input.insertText", json!({"text": text}));
    }

    /// Chooses a file in the input that this selector finds, as a person does in a window of the browser.
    pub fn choose(&mut self, tab: &Tab, selector: &str, file: &std::path::Path) {
        let input = json!({"expression": format!("document.querySelector({})", json!(selector))});
        let mut input = self.ask(Some(tab), "Runtime.evaluate", input);
        let chosen = json!({"files": [file], "objectId": input["result"]["objectId"].take()});
        self.ask(Some(tab), "DOM.setFileInputFiles", chosen);
    }

    /// Goes on by the Tab key until what has the focus makes a JavaScript expression true.
    pub fn tab_to(&mut self, tab: &Tab, expression: &str) {
        for _ in 0..500 {
            // A page whose script has not come yet has nothing that could have the focus.
            if self.is(tab, expression) {
                return;
            }
            self.press(tab, "Tab", 9);
        }
        panic!("no key leads to {expression}: {}", self.value(tab, "document.body.innerText"));
    }

    /// The value of a JavaScript expression.
    pub fn value(&mut self, tab: &Tab, expression: &str) -> Value {
        let mut answer = self.evaluate(tab, expression).unwrap();
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].take()
    }

    fn evaluate(&mut self, tab: &Tab, expression: &str) -> Result<Value, Value> {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        self.try_to(Some(tab), "Runtime.evaluate", asked)
    }

    /// What is wrong with a page for people who see little, use the keyboard, or wear gloves. `before` sets the page, which is looked at before its
    /// server can set it anew. What axe-core finds is told as well.
    pub fn faults(&mut self, tab: &Tab, before: &str) -> Vec<String> {
        let mut faults = texts(self.value(tab, &format!("(() => {{ {before}; return {}; }})()", access())));
        let tree = self.ask(Some(tab), "Accessibility.getFullAXTree", json!({}));
        let nodes = tree["nodes"].as_array().unwrap();
        let is_used = |node: &&Value| {
            let role = node["role"]["value"].as_str().unwrap_or_default();
            ["link", "button", "combobox", "slider", "image", "img", "heading"].contains(&role)
        };
        let unnamed = nodes.iter().filter(is_used).filter(|node| {
            node["ignored"] != json!(true)
                && node["name"]["value"].as_str().is_none_or(|name| name.trim().is_empty())
        });
        faults.extend(unnamed.map(|node| format!("no name: a {}", node["role"]["value"])));
        let script = std::fs::read_to_string(root().join(AXE_FILE));
        let script = script.expect("axe-core is needed: run `make test-packages`");
        faults.extend(texts(self.value(tab, &format!("{script};{AXE}"))));
        faults
    }

    /// Goes through a page by the Tab key, so many times. Where that leads to nothing, back, or to where nobody sees it, it is told.
    pub fn faults_of_focus(&mut self, tab: &Tab, stops: usize) -> Vec<String> {
        let mut faults = Vec::new();
        for _ in 0..stops {
            self.press(tab, "Tab", 9);
            faults.extend(self.value(tab, FOCUS).as_str().map(str::to_owned));
        }
        faults
    }

    /// Whether a JavaScript expression is true. It is not while a page goes, which answers with an error.
    pub fn is(&mut self, tab: &Tab, expression: &str) -> bool {
        self.evaluate(tab, expression).is_ok_and(|answer| answer["result"]["value"] == json!(true))
    }

    /// Waits until a JavaScript expression is true; panics with what the page shows after [`PATIENCE`].
    pub fn until(&mut self, tab: &Tab, expression: &str) {
        let until = Instant::now() + PATIENCE;
        while !self.is(tab, expression) {
            if Instant::now() > until {
                panic!("waited in vain for {expression}: {}", self.value(tab, "document.body.innerText"));
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// A picture of the page as PNG, in Base64.
    pub fn picture(&mut self, tab: &Tab) -> String {
        let picture = self.ask(Some(tab), "Page.captureScreenshot", json!({"format": "png"}));
        picture["data"].as_str().unwrap().to_owned()
    }

    /// Sends a command and waits for its answer.
    fn ask(&mut self, tab: Option<&Tab>, method: &str, parameters: Value) -> Value {
        self.try_to(tab, method, parameters).unwrap()
    }

    /// The same, or the error with which the browser answers.
    fn try_to(&mut self, tab: Option<&Tab>, method: &str, parameters: Value) -> Result<Value, Value> {
        self.number += 1;
        let mut command = json!({"id": self.number, "method": method, "params": parameters});
        if let Some(Tab(session)) = tab {
            command["sessionId"] = json!(session);
        }
        let mut message = command.to_string().into_bytes();
        message.push(0);
        self.commands.write_all(&message).expect("chromium is needed: run `make test-packages`");
        loop {
            let mut answer = self.read();
            if answer["id"] == json!(self.number) {
                return match answer.get("error") {
                    Some(_) => Err(json!([command, answer])),
                    None => Ok(answer["result"].take()),
                };
            }
        }
    }

    fn read(&mut self) -> Value {
        let mut message = Vec::new();
        self.answers.read_until(0, &mut message).unwrap();
        assert_eq!(message.pop(), Some(0), "chromium has ended, or is missing: run `make test-packages`");
        serde_json::from_slice(&message).unwrap()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
