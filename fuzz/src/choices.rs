//! Decisions: from a generator of random numbers, or from bytes that an engine has chosen.

/// Decides what is done to an input.
#[derive(Debug)]
pub struct Choices<'a> {
    /// What an engine has chosen; where it ends every further decision is 0.
    bytes: Option<&'a [u8]>,
    /// State of the generator (splitmix64).
    state: u64,
}

impl<'a> Choices<'a> {
    /// Decisions that follow from a number.
    #[must_use]
    pub fn of_seed(seed: u64) -> Self {
        Self { bytes: None, state: seed }
    }

    /// Decisions that an engine makes.
    #[must_use]
    pub fn of_bytes(bytes: &'a [u8]) -> Self {
        Self { bytes: Some(bytes), state: 0 }
    }

    fn next(&mut self) -> u64 {
        if let Some(bytes) = &mut self.bytes {
            let taken = bytes.len().min(2);
            let value = bytes[..taken].iter().fold(0, |value, byte| value << 8 | u64::from(*byte));
            *bytes = &bytes[taken..];
            return value;
        }
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below a limit; 0 where there is nothing to choose.
    pub fn below(&mut self, limit: usize) -> usize {
        if limit < 2 { 0 } else { (self.next() % limit as u64) as usize }
    }

    /// One of them, if there is one.
    pub fn one<'b, T>(&mut self, of: &'b [T]) -> Option<&'b T> {
        of.get(self.below(of.len()))
    }

    /// Yes once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == times - 1
    }
}
