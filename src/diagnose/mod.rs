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
    choose::forward(&mut data, &mut screen);
    eprintln!("done {:?}", start.elapsed());
    Ok(())
}
