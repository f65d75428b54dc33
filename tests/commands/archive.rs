//! `ballbar blind --archive`: the campaigns of the trials as a data set.

use std::io::Read;
use std::path::Path;

use crate::work::Work;

const MADE: [&str; 7] = ["blind", "--archive", "--seed", "5", "--trials", "1", "--quiet"];

/// One class of the built-in campaign, or of the grid.
fn archive(work: &Work, threads: &str, rest: &[&str]) -> Vec<String> {
    work.ballbar_on(threads, &[&MADE, rest].concat()).done().files()
}

/// Every file of the data set, byte for byte.
fn bytes(work: &Work, files: &[String]) -> Vec<(String, Vec<u8>)> {
    let read =
        |file: &String| (file.clone(), std::fs::read(work.path("results").join(file)).unwrap());
    files.iter().map(read).collect()
}

/// Unpacks a campaign into a folder; gives the names in it.
fn unpack(zip: &Path, into: &Path) -> Vec<String> {
    std::fs::create_dir_all(into).unwrap();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(zip).unwrap()).unwrap();
    let mut names = Vec::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).unwrap();
        let mut content = Vec::new();
        file.read_to_end(&mut content).unwrap();
        let name = file.name().unwrap().into_owned();
        std::fs::write(into.join(&name), content).unwrap();
        names.push(name);
    }
    names
}

fn table(work: &Work) -> String {
    std::fs::read_to_string(work.path("results/campaigns.csv")).unwrap()
}

#[test]
fn the_same_bytes_whenever_and_on_however_many_threads() {
    let (one, two) = (Work::new(), Work::new());
    let classes = ["--class", "single", "--class", "none"];
    let files = archive(&one, "1", &classes);
    assert_eq!(files, ["CITATION.cff", "README.md", "campaigns.csv", "none-0.zip", "single-0.zip"]);
    assert_eq!(archive(&two, "2", &classes), files);
    assert_eq!(bytes(&one, &files), bytes(&two, &files));
    // The command that the description tells makes it again, and what was there stays as it was.
    let readme = std::fs::read_to_string(one.path("results/README.md")).unwrap();
    let command = "ballbar blind --archive --seed 5 --trials 1 --class single --class none";
    assert!(readme.contains(&format!("`{command}`")), "{readme}");
    // Grid campaigns take their place: nothing of the others is left, and what is drawn is told.
    let files = archive(&one, "2", &["--grid", "--class", "none"]);
    assert_eq!(files, ["CITATION.cff", "README.md", "campaigns.csv", "none-0.zip"]);
    assert!(
        table(&one)
            .starts_with("campaign,class,index,hidden,size_um,share_seen,readings_a_second,test,")
    );
    assert_eq!(archive(&two, "1", &["--grid", "--class", "none"]), files);
    assert_eq!(bytes(&one, &files), bytes(&two, &files));
}

#[test]
fn a_campaign_is_analysed_like_one_that_was_measured() {
    let work = Work::new();
    archive(&work, "2", &["--class", "single"]);
    let campaign = work.path("campaign");
    let names = unpack(&work.path("results/single-0.zip"), &campaign);
    for name in
        ["machine.toml", "test.toml", "program1.nc", "program2.nc", "run5.csv", "truth.toml"]
    {
        assert!(names.iter().any(|there| there == name), "{name} is not in {names:?}");
    }
    // The table says what the truth of the campaign says, and the diagnosis names it.
    let truth: toml::Table =
        toml::from_str(&std::fs::read_to_string(campaign.join("truth.toml")).unwrap()).unwrap();
    let effect = truth["effect"].as_str().unwrap();
    assert!(
        table(&work).contains(&format!("single-0.zip,single,0,\"{effect}\",1.0000,")),
        "{}",
        table(&work)
    );
    let cause = effect.split(':').next().unwrap();
    let test = campaign.join("test.toml");
    let outcome = work.plain(&["diagnose", test.to_str().unwrap(), "-o", "found"]).done();
    let found = outcome.stdout();
    assert!(found.contains(&format!("--hide       {cause}:")), "{effect}\n{found}");
}

#[test]
fn one_trial_and_a_test_of_ones_own_are_no_data_set() {
    let work = Work::new();
    for rest in [["--trial", "two:1"].as_slice(), &["test.toml"], &["--list"]] {
        let told = work.ballbar(&[["blind", "--archive"].as_slice(), rest].concat());
        assert_eq!(told.code(), 2, "{}", told.stderr());
        assert!(told.files().is_empty());
    }
}
