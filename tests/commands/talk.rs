//! How the program talks: errors for other programs, what it reads, pages that are opened.

use serde_json::Value;

use crate::work::{Work, data};

/// The last line of stderr as JSON.
fn error(stderr: &str) -> Value {
    let last = stderr.lines().next_back().unwrap();
    serde_json::from_str(last).expect("an error is JSON")
}

#[test]
fn who_reads_json_gets_errors_as_json() {
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"xy\"\nfeed_mm_min = -5.0\n");
    let refused = work.plain(&["plan", "test.toml", "--json"]);
    assert_eq!((refused.code(), refused.stdout().as_str()), (1, ""));
    let told = error(&refused.stderr());
    assert_eq!(told["format"], "ballbar.error/1");
    assert_eq!((&told["exit_code"], &told["error"]["file"]), (&1.into(), &"test.toml".into()));
    assert_eq!(told["error"]["value"], "-5.0", "{told:#}");
    assert!(
        told["error"]["line"].as_u64().unwrap() > 5 && told["error"]["hint"].is_string(),
        "{told:#}"
    );
    let plain = work.plain(&["plan", "test.toml"]).stderr();
    assert!(plain.contains(told["error"]["message"].as_str().unwrap()), "{plain}");

    let gone = error(&work.plain(&["compare", "a", "b", "--json"]).stderr());
    assert!(gone["error"]["message"].as_str().unwrap().contains("cannot read"), "{gone:#}");
    assert_eq!(gone["error"]["line"], Value::Null);

    // Also a command line that cannot be understood.
    let usage = work.plain(&["plan", "--json", "--nonsense"]);
    assert_eq!(usage.code(), 2);
    let told = error(&usage.stderr());
    assert_eq!(told["exit_code"], 2);
    assert!(told["error"]["message"].as_str().unwrap().contains("--nonsense"), "{told:#}");
    assert!(!work.plain(&["plan", "--nonsense"]).stderr().contains('{'));
    assert!(work.plain(&["plan", "--json", "--help"]).done().stdout().contains("Usage"));
}

#[test]
fn verbose_says_what_is_read_and_how_long_it_took() {
    let work = Work::new();
    let test = data("planar").join("test.toml");
    let test = test.to_str().unwrap();
    let verbose = work.plain(&["analyse", test, "-o", "results", "-v", "--json"]).done();
    for told in
        ["reads ", "xy.csv.gz", "identifying: ", "looking for what the model gets wrong: ", "all: "]
    {
        assert!(verbose.stderr().contains(told), "{told}: {}", verbose.stderr());
    }
    assert!(serde_json::from_str::<Value>(&verbose.stdout()).is_ok(), "data stay data");
    let plain = work.plain(&["analyse", test, "-o", "results", "--json"]).done();
    assert!(
        !plain.stderr().contains("reads ") && !plain.stderr().contains("all: "),
        "{}",
        plain.stderr()
    );
    assert_eq!(plain.stdout(), verbose.stdout());
}

/// Whatever opens pages on the system is given the page that was written.
#[cfg(target_os = "linux")]
#[test]
fn a_page_is_opened_where_that_is_wanted() {
    use std::os::unix::fs::PermissionsExt;
    let work = Work::new();
    let opener = "#!/bin/sh\nprintf '%s' \"$1\" > opened.part\nmv opened.part opened\n";
    std::fs::create_dir(work.path("bin")).unwrap();
    work.write("bin/xdg-open", opener);
    std::fs::set_permissions(work.path("bin/xdg-open"), std::fs::Permissions::from_mode(0o755))
        .unwrap();
    work.machine("name", "name").test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n");
    let path = format!("{}:{}", work.path("bin").display(), std::env::var("PATH").unwrap());
    let run = |arguments: &[&str]| {
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .env("PATH", &path)
            .current_dir(work.path("."))
            .args(arguments)
            .output()
            .unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    run(&["plan", "test.toml", "-o", "results", "--open"]);
    let opened = (0..100).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        std::fs::read_to_string(work.path("opened")).ok()
    });
    assert_eq!(opened, Some(work.path("results/plan.html").display().to_string()));
    let none = run(&["compare", "--help"]);
    assert!(none.is_empty());
}
