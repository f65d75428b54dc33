//! What stands on the command line: effects of `--hide` and terms of `--terms`.

use ballbar::model::{CAUSES, Effect, NAMED_SETS, terms};

use super::{Target, accepted, scenario};
use crate::seeds;

pub const TARGET: Target = Target {
    name: "effect",
    seeds: || {
        let effects = [
            "cyclic:on=EXX,amplitude_um=1.2,period_mm=10,phase_rad=0",
            "drift:on=EXX1,amplitude_um_m=12,time_constant_s=600",
            "roundness:amplitude_um=0.3,degree=3,order=-2",
            "servo:on=Y,delay_ms=-0.4",
            "knock:on=EXt,step_um=1,moment_s=1,run=2",
            "coefficient:on=EBX3,value=0.1",
            "ball-place:on=EXw,offset_mm=1,mounting=1",
            "pivot:on=X",
            "observable35,-EAZ3,EXt@A,cyclic:on=EXX,EXX1",
        ];
        let mut seeds: Vec<Vec<u8>> = effects.map(|text| text.as_bytes().to_vec()).into();
        seeds.extend(
            CAUSES.iter().map(|cause| format!("{}:on=EXX,amplitude_um=1", cause.id).into_bytes()),
        );
        seeds.extend(NAMED_SETS.map(|(name, _)| name.as_bytes().to_vec()));
        seeds
    },
    words: scenario::WORDS,
    made: &[],
    read,
};

fn read(input: &[u8]) -> bool {
    let text = seeds::as_text(input);
    let effect = Effect::parse(&text);
    if let Ok(effect) = &effect {
        let again = Effect::parse(&effect.to_string());
        assert!(again.is_ok(), "`{effect}` does not read back: {again:?}");
    }
    let names: Vec<String> = text.split([';', '\n']).map(str::to_owned).collect();
    let chosen = terms(&names, &["A".to_owned(), "B".to_owned()]).map(|_| ());
    accepted(&chosen) | accepted(&effect)
}
