/// A small generator (SplitMix64): which file is broken how follows from the seed alone.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// The generator of one file of a campaign.
    pub(crate) fn new(seed: u64, file: u64) -> Self {
        let mut random = Self(seed ^ file.wrapping_mul(0xd1b5_4a32_d192_ed03));
        random.next();
        random
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `most`; 0 if that is 0.
    pub(crate) fn below(&mut self, most: usize) -> usize {
        if most == 0 {
            return 0;
        }
        (self.next() % most as u64) as usize
    }

    /// One of several; `None` of none.
    pub(crate) fn pick<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        of.get(self.below(of.len()))
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.next() as u8
    }
}
