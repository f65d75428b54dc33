use ballbar::*;
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let test = plan::Test::read(Path::new(&a[1])).unwrap_or_else(|e| panic!("{e}"));
    let machine = test.machine().unwrap_or_else(|e| panic!("{e}"));
    let mounts: Vec<_> = test.mountings().iter().map(|m| m.mounting).collect();
    let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
    let terms_list: Vec<String> = if a.len() > 2 { a[2].split(',').map(|s| s.to_string()).collect() } else { test.estimation().terms.clone() };
    let mut groups: std::collections::BTreeMap<u32, Vec<usize>> = Default::default();
    for (i, r) in test.runs().unwrap().iter().enumerate() { groups.entry(r.repeat).or_default().push(i); }
    for (g, idx) in groups {
        let t0 = std::time::Instant::now();
        let mut inputs = vec![];
        for i in idx {
            let run = &test.runs().unwrap()[i];
            let l = log::read(&run.log, test.log_format()).unwrap_or_else(|e| panic!("{e}"));
            let mut reading = nc::Reading::default();
            for m in test.mountings() { reading.work_offsets_mm.insert(m.work_offset, m.mounting.coincidence_mm); }
            let p = nc::read_file(&run.program, &reading).unwrap_or_else(|e| panic!("{e}"));
            let al = align::align(&l, &p, &machine, &mounts[run.mounting], test.ball_bar(), run.feed_override).unwrap_or_else(|e| panic!("{e}"));
            eprintln!("run {} align {:?}: marks {:?}\n map rate {:.2} ppm offsets {:?} pauses {:?}", run.name, t0.elapsed(), al.marks, al.time_map.rate*1e6, al.time_map.offsets_s, al.time_map.pauses_s());
            for s in &al.sections { eprintln!("   {:?} fw {} tr {} {:.2}..{:.2} {:.2}", s.name, s.forward, s.transit, s.start_s, s.end_s, s.sweep_rad.to_degrees()); }
            inputs.push(identify::RunInput { name: run.name.clone(), mounting: run.mounting, alignment: al });
        }
        let terms = model::terms(&terms_list, &names).unwrap();
        let m = model::Model::new(&machine, mounts.clone(), terms);
        let o = identify::Options { nominal_mm: test.ball_bar().length_mm, noise_mm: test.ball_bar().noise_mm, clock_tolerance: test.ball_bar().clock_tolerance, loss: test.estimation().loss, minimum_norm: a.len() > 3 };
        let r = identify::identify(&m, inputs, &o).unwrap_or_else(|e| panic!("{e}"));
        eprintln!("repeat {g}: {:?} rms {:.4} um used {} steps {} rank {} floor {:.2e} cond {:.0} noise {:?} sv last {:.2e}", t0.elapsed(), r.rms_mm*1e3, r.used, r.steps, r.rank, r.floor, r.condition, r.noise, r.singular_values.last().unwrap());
        for d in &r.null_directions { eprintln!("   {}", identify::sentence(d, m.parameters())); }
        for run in &r.runs { let t=&run.alignment.time_map; eprintln!(" rate {:.2}±{:.2} ppm offs {:?} sig {:?} pauses {:?}", t.rate*1e6, t.rate_sigma*1e6, t.offsets_s, t.offset_sigmas_s, t.pauses_s()); 
          println!("MAP {} {} {} {}", run.name, t.rate, t.pivot_s, t.offsets_s.iter().map(|o| o.to_string()).collect::<Vec<_>>().join(","));
          println!("SIG {} {}", run.name, t.offset_sigmas_s.iter().map(|o| o.to_string()).collect::<Vec<_>>().join(","));
          println!("STOPS {} {}", run.name, t.stops_s().iter().map(|o| o.to_string()).collect::<Vec<_>>().join(","));
        }
        if std::env::var_os("RES").is_some() { for (run, rec) in r.runs.iter().zip(&r.records) { for (s, q) in run.alignment.samples.iter().zip(rec) { if let align::Place::Arc(k) = s.place { println!("RES {} {} {:.6} {:.4} {:.6} {} {} {} {:.5}", run.name, k, s.program_s, s.log_s, q.residual_mm*1e3, s.pose.position_mm.x, s.pose.position_mm.y, s.pose.position_mm.z, q.predicted_mm*1e3); } } } }
        for e in &r.estimates { println!("EST {} {} {} {}", r.runs[0].name, e.parameter.name, e.value, e.sigma); }
    }
}
