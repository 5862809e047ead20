//! The page in a real browser: headless Chromium opens it from `file://`, and mouse and keys do what they promise.
//!
//! `cargo test --features browser --test browser`. The browser is looked for as `$RASTRAY_CHROMIUM`, then `chromium`,
//! `chromium-browser`, `google-chrome` and `chrome` on the path; where there is none the tests say so and pass, or fail where
//! `RASTRAY_REQUIRE_BROWSER=1`. It is driven over its debugging pipe (two named pipes; Unix). `RASTRAY_SCREENSHOTS=FOLDER`
//! keeps pictures of the page in light, dark, narrow, on a projector, and its printed pages, to be looked at.

#![cfg(unix)]

#[path = "../common"]
mod common {
    pub(crate) mod demand;
}

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use base64::Engine;
use common::demand::skip;
use exr::prelude::{ReadChannels, ReadLayers, read};
use serde_json::{Value, json};

const PATIENCE: Duration = Duration::from_secs(60);

/// The browser with one open page.
struct Browser {
    child: Child,
    to: File,
    from: Receiver<Value>,
    session: Option<String>,
    last: u64,
    /// Errors that the page's script threw.
    thrown: Vec<String>,
    _profile: tempfile::TempDir,
}

fn executable() -> Option<PathBuf> {
    if let Some(given) = std::env::var_os("RASTRAY_CHROMIUM") {
        return Some(given.into());
    }
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let found = |name: &&str| folders.iter().map(|f| f.join(name)).find(|p| p.is_file());
    names.iter().find_map(found)
}

impl Browser {
    /// Starts it; none, and a line that says so, where there is none.
    fn start() -> Option<Self> {
        let Some(program) = executable() else {
            let missing = "no Chromium found; install it, or set RASTRAY_CHROMIUM";
            skip("RASTRAY_REQUIRE_BROWSER", missing);
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder");
        let pipes = ["in", "out"].map(|name| profile.path().join(name));
        let made = Command::new("mkfifo").args(&pipes).status();
        assert!(made.expect("mkfifo runs").success());
        // The page is this test's own: the sandbox, which root may not have, protects nothing.
        let line = "exec \"$0\" --headless=new --no-sandbox --disable-gpu --hide-scrollbars --no-first-run \
                    --remote-debugging-pipe --user-data-dir=\"$1\" about:blank 3<\"$2\" 4>\"$3\"";
        let child = Command::new("sh")
            .args(["-c", line])
            .arg(program)
            .arg(profile.path().join("profile"))
            .args(&pipes)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("sh runs");
        let to = OpenOptions::new().write(true).open(&pipes[0]);
        let answers = BufReader::new(File::open(&pipes[1]).expect("a pipe"));
        let (send, from) = channel();
        std::thread::spawn(move || {
            for message in answers.split(0).map_while(Result::ok) {
                let Ok(value) = serde_json::from_slice(&message) else {
                    continue;
                };
                if send.send(value).is_err() {
                    break;
                }
            }
        });
        let mut browser = Self {
            child,
            to: to.expect("a pipe"),
            from,
            session: None,
            last: 0,
            thrown: Vec::new(),
            _profile: profile,
        };
        let page = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": page["targetId"], "flatten": true});
        let attached = browser.call("Target.attachToTarget", attach);
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Asks the browser and waits for its answer.
    fn call(&mut self, method: &str, params: Value) -> Value {
        self.last += 1;
        let id = self.last;
        let mut message = json!({"id": id, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.to.write_all(&bytes).expect("the browser listens");
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let answer = self.from.recv_timeout(left);
            let mut answer = answer.unwrap_or_else(|e| panic!("{method}: no answer: {e}"));
            if answer["method"] == "Runtime.exceptionThrown" {
                let details = &answer["params"]["exceptionDetails"];
                self.thrown.push(details.to_string());
            }
            if answer["id"] == id {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].take();
            }
        }
    }

    /// The value of an expression, awaited.
    fn value(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let mut answer = self.call("Runtime.evaluate", params);
        let thrown = &answer["exceptionDetails"];
        assert!(thrown.is_null(), "{expression}: {thrown}");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    fn until(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(&format!("Boolean({expression})")) != true {
            assert!(start.elapsed() < PATIENCE, "never true: {expression}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn window(&mut self, width: u32, height: u32, scheme: &str) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
        self.call("Emulation.setDeviceMetricsOverride", metrics);
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.call("Emulation.setEmulatedMedia", features);
    }

    /// Opens a page, afresh, and waits until its pictures are drawn.
    fn open(&mut self, page: &Path, hash: &str) {
        self.call("Page.navigate", json!({"url": "about:blank"}));
        let url = format!("file://{}{hash}", page.display());
        self.call("Page.navigate", json!({"url": url}));
        self.until(
            "window.rastray && rastray.ready() && document.getElementById('alt').textContent",
        );
    }

    /// The middle of an element, scrolled into view.
    fn middle(&mut self, selector: &str) -> [f64; 2] {
        let place = self.value(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        ));
        [0, 1].map(|k| place[k].as_f64().expect("a place"))
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], button: &str) {
        let buttons = u32::from(button == "left" && kind != "mouseReleased");
        let params = json!({"type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", params);
    }

    fn click(&mut self, selector: &str) {
        let place = self.middle(selector);
        self.mouse("mousePressed", place, "left");
        self.mouse("mouseReleased", place, "left");
    }

    fn key(&mut self, key: &str) {
        let code = match key {
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            "Home" => 36,
            "Enter" => 13,
            " " => 32,
            "Tab" => 9,
            other => other.to_uppercase().bytes().next().map_or(0, u32::from),
        };
        let text = match key {
            "Enter" => "\r",
            key if key.len() == 1 => key,
            _ => "",
        };
        for kind in ["keyDown", "keyUp"] {
            let mut params = json!({"type": kind, "key": key, "windowsVirtualKeyCode": code});
            if kind == "keyDown" && !text.is_empty() {
                params["text"] = json!(text);
            }
            self.call("Input.dispatchKeyEvent", params);
        }
    }

    /// Bytes of a picture of the window, or of the printed pages.
    fn bytes(&mut self, method: &str, params: Value) -> Vec<u8> {
        let answer = self.call(method, params);
        let data = answer["data"].as_str().expect("data");
        base64::engine::general_purpose::STANDARD
            .decode(data)
            .expect("base 64")
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Makes a comparison; returns its folder.
fn compare(scene: &str, size: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let out = Command::new(env!("CARGO_BIN_EXE_rastray"))
        .args(["compare", scene, "--size", size, "-q", "-o"])
        .arg(folder.path())
        .output()
        .expect("rastray runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}");
    folder
}

/// All layers of `layers.exr` by channel name.
struct Layers {
    width: usize,
    channels: Vec<(String, Vec<f32>)>,
}

impl Layers {
    fn read(folder: &Path) -> Self {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(folder.join("layers.exr"))
            .expect("an EXR");
        let width = image.layer_data.size.0;
        let channels = image.layer_data.channel_data.list.iter();
        let channels = channels
            .map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect()))
            .collect();
        Self { width, channels }
    }

    /// A layer's colour at a pixel; 0 where the file has no such layer.
    fn at(&self, name: &str, [x, y]: [usize; 2]) -> [f64; 3] {
        ["R", "G", "B"].map(|letter| {
            let full = format!("{name}.{letter}");
            let found = self.channels.iter().find(|(n, _)| *n == full);
            found.map_or(0.0, |(_, v)| f64::from(v[y * self.width + x]))
        })
    }

    /// The same without S_L where the file has it.
    fn unshadowed(&self, name: &str, pixel: [usize; 2]) -> [f64; 3] {
        let free = format!("unshadowed.{name}");
        let has = self.channels.iter().any(|(n, _)| *n == format!("{free}.R"));
        self.at(if has { &free } else { name }, pixel)
    }
}

/// A mix: which terms are on, and for each light its terms, strength and colour.
struct Mix {
    terms: &'static str,
    lights: Vec<(&'static str, f64, [u8; 3])>,
}

impl Mix {
    fn hash(&self) -> String {
        let lights: Vec<String> = self
            .lights
            .iter()
            .map(|(terms, strength, [r, g, b])| format!("{terms},{strength},{r:02x}{g:02x}{b:02x}"))
            .collect();
        format!("#r=mix&m={}&g={}", self.terms, lights.join(";"))
    }

    /// The same sum from the float layers of the EXR, and its largest layer, channel by channel.
    fn expected(&self, exr: &Layers, names: &[&str], pixel: [usize; 2]) -> [(f64, f64); 3] {
        let shadows = self.terms.contains('s');
        let layer = |name: &str| {
            if shadows {
                exr.at(name, pixel)
            } else {
                exr.unshadowed(name, pixel)
            }
        };
        let mut summands: Vec<[f64; 3]> = Vec::new();
        let mut add = |on: bool, gain: [f64; 3], color: [f64; 3]| {
            if on {
                summands.push([0, 1, 2].map(|c| gain[c] * color[c]));
            }
        };
        let has = |letter: char| self.terms.contains(letter);
        add(has('E'), [1.0; 3], layer("emission"));
        add(has('A'), [1.0; 3], layer("ambient"));
        for (name, (terms, strength, tint)) in names.iter().zip(&self.lights) {
            let gain = tint.map(|t| strength * f64::from(t) / 255.0);
            for (letter, term) in [('A', "ambient"), ('D', "diffuse"), ('S', "specular")] {
                let on = has(letter) && terms.contains(letter);
                add(on, gain, layer(&format!("{term}.{name}")));
            }
            for (letter, term) in [('R', "reflection"), ('T', "refraction")] {
                add(has(letter), gain, layer(&format!("split.{term}.{name}")));
            }
        }
        for (letter, term) in [('R', "reflection"), ('T', "refraction")] {
            add(has(letter), [1.0; 3], layer(&format!("split.{term}")));
        }
        [0, 1, 2].map(|c| {
            let of = summands.iter().map(|s| s[c]);
            (of.clone().sum(), of.fold(0.0, |m: f64, x| m.max(x.abs())))
        })
    }
}

/// Every mix that is tried: switches in every direction, strengths up to the end of the slider, colours.
fn mixes() -> Vec<Mix> {
    let white = [255; 3];
    let usual = || vec![("ADS", 1.0, white); 2];
    vec![
        Mix {
            terms: "EADSsRT",
            lights: usual(),
        },
        Mix {
            terms: "EADS",
            lights: usual(),
        },
        Mix {
            terms: "EADSRT",
            lights: usual(),
        },
        Mix {
            terms: "DsR",
            lights: vec![("ADS", 2.0, [255, 128, 0]), ("S", 0.5, white)],
        },
        Mix {
            terms: "EASsT",
            lights: vec![("AS", 1.5, [10, 200, 255]), ("ADS", 0.0, white)],
        },
        Mix {
            terms: "ADST",
            lights: vec![("D", 0.37, white), ("ADS", 2.0, [255, 0, 90])],
        },
        Mix {
            terms: "",
            lights: usual(),
        },
    ]
}

#[test]
fn a_mixed_pixel_is_the_sum_of_the_layers_of_the_exr() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = compare("whitted", "96x72");
    let exr = Layers::read(folder.path());
    let page = folder.path().join("index.html");
    browser.window(1280, 900, "light");
    browser.open(&page, "");
    let names = ["sun", "lamp"];
    let (mut worst, mut seen) = (0.0f64, 0);
    for mix in mixes() {
        browser.value(&format!("location.hash = {:?}", mix.hash()));
        browser.until(&format!("rastray.state().terms === {:?}", mix.terms));
        let values = browser.value(
            "(async () => { const all = []; for (let y = 0; y < 72; y += 3) for (let x = 0; x < 96; x += 3) \
             all.push([x, y, ...(await rastray.value('mix', x, y))]); return all; })()",
        );
        for value in values.as_array().expect("a list") {
            let number = |k: usize| value[k].as_f64().expect("a number");
            let pixel = [number(0) as usize, number(1) as usize];
            let expected = mix.expected(&exr, &names, pixel);
            for (c, (sum, largest)) in expected.into_iter().enumerate() {
                let error = (number(2 + c) - sum).abs() / largest.max(1.0);
                assert!(
                    error <= 2f64.powi(-9),
                    "{} at {pixel:?}: {} is not {sum}",
                    mix.hash(),
                    number(2 + c)
                );
                worst = worst.max(error);
                seen += usize::from(sum != 0.0);
            }
        }
    }
    println!(
        "largest error of a mixed value: {worst:.2e}, of {:.2e}",
        2f64.powi(-9)
    );
    assert!(seen > 5000, "only {seen} values were not 0");
    assert_eq!(browser.thrown, [""; 0]);
}

#[test]
fn pictures_are_the_files_beside_the_page() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = compare("highlight", "64x48");
    browser.open(&folder.path().join("index.html"), "");
    for (id, file) in [("r0", "raster.png"), ("r9", "trace.png")] {
        let picture = image::open(folder.path().join(file))
            .expect("a PNG")
            .to_rgb8();
        let values = browser.value(&format!(
            "(async () => {{ const all = []; for (let y = 0; y < 48; y++) for (let x = 0; x < 64; x++) \
             all.push(...(await rastray.value('{id}', x, y))); return all; }})()"
        ));
        let values = values.as_array().expect("a list");
        assert_eq!(values.len(), picture.as_raw().len());
        for (value, byte) in values.iter().zip(picture.as_raw()) {
            assert_eq!(value.as_f64(), Some(f64::from(*byte) / 255.0), "{file}");
        }
    }
    assert_eq!(browser.thrown, [""; 0]);
}

#[test]
fn mouse_and_keys_do_what_they_promise() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = compare("whitted", "96x72");
    let page = folder.path().join("index.html");
    browser.window(1280, 900, "light");
    browser.open(&page, "");

    // Drag the handle a quarter of the stage to the left.
    let from = browser.middle("#handle");
    let width = browser
        .value("document.getElementById('stage').clientWidth")
        .as_f64();
    let to = [from[0] - width.expect("a width") / 4.0, from[1]];
    browser.mouse("mousePressed", from, "left");
    browser.mouse("mouseMoved", [f64::midpoint(from[0], to[0]), to[1]], "left");
    browser.mouse("mouseMoved", to, "left");
    browser.mouse("mouseReleased", to, "left");
    let split = browser
        .value("rastray.state().split")
        .as_f64()
        .expect("a number");
    assert!((split - 25.0).abs() < 1.0, "{split}");
    assert_eq!(browser.value("rastray.state().pixel"), Value::Null);

    // The same with keys.
    browser.value("document.getElementById('handle').focus()");
    browser.key("Home");
    assert_eq!(browser.value("rastray.state().split"), 0);
    for _ in 0..3 {
        browser.key("ArrowRight");
    }
    assert_eq!(
        browser.value("document.getElementById('handle').getAttribute('aria-valuenow')"),
        "3"
    );

    // A click tells the pixel's numbers and the line that explains it.
    browser.click("#stage");
    browser.until("document.querySelectorAll('#story tbody tr').length > 12");
    assert_eq!(browser.value("rastray.state().pixel"), json!([48, 36]));
    let line = browser.value("document.getElementById('command').textContent");
    assert_eq!(line, "rastray explain whitted 48 36 --size 96x72");
    // So do arrow keys and Enter.
    browser.value("document.getElementById('stage').focus()");
    for key in ["ArrowLeft", "ArrowLeft", "ArrowDown", "Enter"] {
        browser.key(key);
    }
    assert_eq!(browser.value("rastray.state().pixel"), json!([46, 37]));

    // A pixel that was explained beforehand shows its ray tree.
    browser.value("(() => { const list = document.getElementById('telling'); list.selectedIndex = 1; list.dispatchEvent(new Event('input')); })()");
    browser.until("document.querySelectorAll('#story .tree details').length >= 2");

    // Switches of the mixer, and the equation that follows them.
    browser.click("[data-switch=s]");
    browser.until("rastray.state().right === 'mix'");
    assert_eq!(browser.value("rastray.state().terms"), "EADSRT");
    browser.until("document.querySelector('[data-term=s]').classList.contains('off')");
    browser.click("[data-term=T]");
    assert_eq!(browser.value("rastray.state().terms"), "EADSR");
    browser.value("document.getElementById('light0-strength').focus()");
    browser.key("ArrowRight");
    assert_eq!(browser.value("rastray.state().lights[0].strength"), 1.01);

    // A cause shows where it is, with an exposure that fits; keys change the look.
    browser.click("[data-cause='5']");
    assert_eq!(
        browser.value("[rastray.state().left, rastray.state().right, rastray.state().look].join()"),
        "r5,r6,signed"
    );
    browser.value("document.activeElement.blur()");
    browser.key("3");
    assert_eq!(browser.value("rastray.state().look"), "error");
    browser.until("document.getElementById('alt').textContent.startsWith('rung 5')");
    let alt = browser
        .value("document.getElementById('alt').textContent")
        .to_string();
    assert!(
        alt.contains("rmse") && alt.contains("of the pixels differ, mostly at the"),
        "{alt}"
    );

    // The address holds it all: the same view after a reload.
    browser.until("location.hash.includes('v=error')");
    let state = browser.value("JSON.stringify(rastray.state())");
    let hash = browser.value("location.hash");
    browser.open(&page, hash.as_str().expect("a hash"));
    assert_eq!(browser.value("JSON.stringify(rastray.state())"), state);
    assert_eq!(browser.thrown, [""; 0]);
}

#[test]
fn every_control_can_be_reached_and_has_a_name() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = compare("whitted", "48x36");
    browser.window(1280, 900, "light");
    browser.open(&folder.path().join("index.html"), "");
    let nameless = browser.value(
        "[...document.querySelectorAll('button, input, select, [role=slider], canvas[role=img]')].filter((e) => !e.closest('[hidden]')) \
         .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length)).map((e) => e.outerHTML)",
    );
    assert_eq!(nameless, json!([]));
    // Tab goes through all of them, and what has the focus can be seen.
    let mut reached = std::collections::BTreeSet::new();
    browser.value("document.body.focus()");
    for _ in 0..90 {
        browser.key("Tab");
        let at = browser.value("(() => { const e = document.activeElement; return e.id || e.dataset.switch || e.dataset.cause || e.dataset.preset || e.tagName; })()");
        reached.insert(at.as_str().unwrap_or("").to_owned());
        let seen = browser.value(
            "(() => { const e = document.activeElement; const box = e.type === 'radio' ? e.parentElement : e; const s = getComputedStyle(box); \
             return e === document.body || s.outlineStyle !== 'none' || getComputedStyle(e, '::after').boxShadow !== 'none'; })()",
        );
        assert_eq!(seen, true, "no focus to be seen at {at}");
    }
    for id in [
        "left",
        "right",
        "swap",
        "hatch",
        "stage",
        "handle",
        "s",
        "light0-strength",
        "light0-tint",
        "all",
        "5",
        "x",
        "y",
    ] {
        assert!(
            reached.contains(id),
            "{id} is not reached by Tab: {reached:?}"
        );
    }
    assert_eq!(browser.thrown, [""; 0]);
}

#[test]
fn it_fits_narrow_and_wide_windows_and_two_pages() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = compare("whitted", "160x120");
    let page = folder.path().join("index.html");
    let keep = std::env::var_os("RASTRAY_SCREENSHOTS").map(PathBuf::from);
    for (name, width, height, scheme) in [
        ("light", 1280, 900, "light"),
        ("dark", 1280, 900, "dark"),
        ("narrow", 390, 844, "light"),
        ("projector", 1920, 1080, "light"),
    ] {
        browser.window(width, height, scheme);
        browser.open(&page, "#p=80,60");
        browser.until("document.querySelectorAll('#story tbody tr').length > 12");
        let wide = browser.value("document.documentElement.scrollWidth");
        assert!(wide.as_u64() <= Some(u64::from(width)), "{name}: {wide}");
        let shot = browser.bytes(
            "Page.captureScreenshot",
            json!({"captureBeyondViewport": true}),
        );
        let picture = image::load_from_memory(&shot).expect("a picture").to_rgb8();
        let first = *picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|p| *p != first), "{name} is empty");
        assert_eq!(first[0] < 64, scheme == "dark", "{name}: {first:?}");
        if let Some(folder) = &keep {
            std::fs::write(folder.join(format!("{name}.png")), shot).expect("a file");
        }
    }
    let print = json!({"printBackground": true, "preferCSSPageSize": true});
    let pdf = browser.bytes("Page.printToPDF", print);
    let text = String::from_utf8_lossy(&pdf);
    let pages = text.matches("/Type /Page\n").count() + text.matches("/Type /Page/").count();
    assert_eq!(pages, 2, "printed pages");
    if let Some(folder) = &keep {
        std::fs::write(folder.join("print.pdf"), pdf).expect("a file");
    }
    assert_eq!(browser.thrown, [""; 0]);
}
