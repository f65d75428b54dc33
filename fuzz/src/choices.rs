//! Decisions from a generator of random numbers.

/// Decides what is done to an input.
#[derive(Debug)]
pub struct Choices {
    /// State of the generator (splitmix64).
    state: u64,
}

impl Choices {
    /// Decisions that follow from a number.
    #[must_use]
    pub fn of_seed(seed: u64) -> Self {
        Self { state: seed }
    }

    fn next(&mut self) -> u64 {
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
