use ballbar::identify::{Campaign, Failure};
fn main() {
    let test = ballbar::plan::Test::read(std::env::args().nth(1).unwrap().as_ref()).unwrap();
    let machine = test.machine().unwrap();
    let start = std::time::Instant::now();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    for r in &campaign.repeats {
        println!("offsets {:?}", r.runs[0].alignment.time_map.offsets_s);
    }
    eprintln!("identified {:?}", start.elapsed());
    let d = ballbar::diagnose::diagnose(&test, &machine, &campaign).unwrap();
    eprintln!("diagnosed {:?}", start.elapsed());
    println!("{:#?}", d.verdict);
    for f in &d.findings {
        println!(
            "FOUND {:?} rms {:.4} um",
            f.effects.iter().map(|e| e.to_string()).collect::<Vec<_>>(),
            1e3 * f.rms_mm
        );
        for n in &f.numbers {
            println!("    {} = {} +- {:?}", n.name, n.value, n.sigma);
        }
        for rival in &f.rivals {
            println!(
                "      or {} share {:.4} {:?}",
                rival.element.shape().unwrap().name(),
                rival.share,
                rival.told
            );
        }
        if f.effects.is_empty() {
            println!("{:?}", f.element);
        }
    }
    for r in &d.runs {
        println!("{r:?}");
    }
    for r in &d.programs {
        println!("{r:?}");
    }
    for r in &d.moved {
        println!("{r:?}");
    }
}
