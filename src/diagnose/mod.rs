//! What the model gets wrong.

mod channel;
mod choose;
mod curves;
mod data;
mod element;
mod joint;
mod knock;
mod noise;
mod screen;
mod vibration;

pub use element::{Element, Form, Owner};

use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;

/// Looks.
pub fn diagnose(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<()> {
    let start = std::time::Instant::now();
    let mut data = data::Data::new(test, machine, campaign)?;
    eprintln!("data {:?} {} samples", start.elapsed(), data.samples());
    let mut screen = screen::Screen::new(&data, &campaign.terms);
    eprintln!("screen {:?} {} channels", start.elapsed(), screen.channels.len());
    let n = data.samples() as f64;
    let chosen = choose::Search { data: &mut data, screen: &mut screen }.run();
    if let Some(chosen) = chosen {
        for (k, element) in chosen.fitted.elements.iter().enumerate() {
            let name = element.shape().map_or_else(|| format!("{element:?}").chars().take(150).collect(), |s| s.name());
            eprintln!("FOUND {name} {:?}", chosen.fitted.amplitudes[k].iter().take(4).collect::<Vec<_>>());
            for rival in &chosen.rivals[k] {
                eprintln!("      or {} share {:.4} {:?}", rival.element.shape().unwrap().name(), rival.share, rival.told);
            }
        }
    }
    eprintln!("left {:.4} um", 1e3 * (data.squares_mm2() / n).sqrt());
    eprintln!("done {:?}", start.elapsed());
    Ok(())
}
