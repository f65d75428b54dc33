use ballbar::identify::{Campaign, Failure};
fn main() {
    let test = ballbar::plan::Test::read(std::env::args().nth(1).unwrap().as_ref()).unwrap();
    let machine = test.machine().unwrap();
    let start = std::time::Instant::now();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    eprintln!("identified {:?}", start.elapsed());
    ballbar::diagnose::diagnose(&test, &machine, &campaign).unwrap();
}
