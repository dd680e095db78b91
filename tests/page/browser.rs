//! Chromium without a window, driven as a reader would: clicks, keys and pointer, by its own driver.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A key of WebDriver's alphabet: Enter.
pub const ENTER: &str = "\u{e007}";

/// One browser with one page.
pub struct Browser {
    driver: Child,
    session: String,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts Chromium; `None` where it is not installed, which is said, or with `PHR_BROWSER` in the environment a
    /// failure.
    pub fn start() -> Option<Self> {
        let started =
            Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let is_there =
            Command::new("chromium").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        let (Ok(mut driver), Ok(_)) = (started, is_there) else {
            let reason = "no chromium and chromedriver here; apt-get install chromium chromium-driver (`make test` does)";
            assert!(std::env::var_os("PHR_BROWSER").is_none(), "{reason}, or unset PHR_BROWSER");
            eprintln!("skipped: {reason}");
            return None;
        };
        let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = lines.map_while(Result::ok).find_map(|line| {
            let (_, port) = line.split_once("successfully on port ")?;
            port.trim_end_matches('.').parse::<u16>().ok()
        });
        let root = format!("http://127.0.0.1:{}/session", port.expect("chromedriver tells its port"));
        let profile = tempfile::tempdir().unwrap();
        let arguments = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--hide-scrollbars",
            "--window-size=1400,900",
            &format!("--user-data-dir={}", profile.path().display()),
        ];
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
            "goog:chromeOptions": { "args": arguments },
        } } });
        let mut browser = Self { driver, session: root.clone(), _profile: profile };
        let answer = browser.post("", &wanted);
        browser.session = format!("{root}/{}", answer["sessionId"].as_str().expect("a session"));
        Some(browser)
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        let sent = minreq::post(format!("{}{path}", self.session)).with_body(body.to_string()).send();
        let response = sent.unwrap_or_else(|error| panic!("{path}: {error}"));
        let mut answer: Value = serde_json::from_slice(response.as_bytes()).unwrap();
        assert!(answer["value"]["error"].is_null(), "{path} {body}: {}", answer["value"]["message"]);
        answer["value"].take()
    }

    /// A command of the browser's own protocol.
    fn protocol(&self, command: &str, parameters: Value) {
        self.post("/goog/cdp/execute", &json!({ "cmd": command, "params": parameters }));
    }

    /// Opens a file.
    pub fn open(&self, file: &Path) {
        self.post("/url", &json!({ "url": format!("file://{}", file.display()) }));
    }

    /// Shows the page as on a screen of this size, in a light or dark room.
    pub fn screen(&self, width: u32, height: u32, scheme: &str) {
        self.protocol(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 }),
        );
        self.protocol(
            "Emulation.setEmulatedMedia",
            json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] }),
        );
    }

    /// What a script returns.
    pub fn script(&self, script: &str) -> Value {
        self.post("/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// The texts of the elements that a selector finds, spaces made plain.
    pub fn texts(&self, selector: &str) -> Vec<String> {
        let list = self.script(&format!(
            "return [...document.querySelectorAll({})].map((one) => one.textContent.replace(/\\s+/g, ' ').trim())",
            json!(selector)
        ));
        serde_json::from_value(list).unwrap()
    }

    fn element(&self, selector: &str) -> String {
        let found = self.post("/element", &json!({ "using": "css selector", "value": selector }));
        found.as_object().unwrap().values().next().unwrap().as_str().unwrap().to_owned()
    }

    /// Clicks the first element that a selector finds; an option is chosen so.
    pub fn click(&self, selector: &str) {
        // Not below the choices that stay at the top.
        self.script(&format!(
            "document.querySelector({}).closest('select, button, input, th').scrollIntoView({{ block: 'center' }})",
            json!(selector)
        ));
        self.post(&format!("/element/{}/click", self.element(selector)), &json!({}));
    }

    /// Types into the first element that a selector finds.
    pub fn keys(&self, selector: &str, text: &str) {
        self.post(&format!("/element/{}/value", self.element(selector)), &json!({ "text": text }));
    }

    /// Moves the pointer onto the first element that a selector finds.
    pub fn point_at(&self, selector: &str) {
        let on = json!({ "element-6066-11e4-a52e-4f735466cecf": self.element(selector) });
        let move_to = |origin: &Value, x: i32| json!({ "type": "pointerMove", "duration": 50, "origin": origin, "x": x, "y": 0 });
        let pointer = json!({
            "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" },
            "actions": [move_to(&on, 3), move_to(&on, 0)],
        });
        self.post("/actions", &json!({ "actions": [pointer] }));
    }

    /// Messages of the browser's console.
    pub fn console(&self) -> Vec<String> {
        let log = self.post("/se/log", &json!({ "type": "browser" }));
        log.as_array().unwrap().iter().map(|entry| entry["message"].to_string()).collect()
    }

    /// Addresses that were asked for since the last call, those of the pages themselves and of data within them too.
    pub fn requests(&self) -> Vec<String> {
        let log = self.post("/se/log", &json!({ "type": "performance" }));
        let messages = log.as_array().unwrap().iter().map(|entry| entry["message"].as_str().unwrap());
        messages
            .filter_map(|message| {
                let message: Value = serde_json::from_str(message).unwrap();
                let message = &message["message"];
                let is_request = message["method"] == "Network.requestWillBeSent";
                is_request.then(|| message["params"]["request"]["url"].as_str().unwrap().to_owned())
            })
            .collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The driver ends the browser with the session; if it cannot, both end with the driver.
        let _ = minreq::delete(&self.session).send();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
