//! Which lit vertex has which number within a tile: a small hash table that is cheap to empty.

/// Numbers (vertex, surface) pairs in the order in which they are first met.
#[derive(Clone, Debug)]
pub(super) struct SlotMap {
    /// Open addressing, a power of two places; [`EMPTY`] where none.
    keys: Vec<u64>,
    slots: Vec<u32>,
    /// Places in use.
    used: Vec<u32>,
}

/// No vertex number reaches 2^32 - 1 together with such a surface: MAX_TRIANGLES bounds both.
const EMPTY: u64 = u64::MAX;

impl SlotMap {
    /// No pairs.
    pub(super) fn new() -> Self {
        Self::with_places(1 << 10)
    }

    fn with_places(places: usize) -> Self {
        Self {
            keys: vec![EMPTY; places],
            slots: vec![0; places],
            used: Vec::new(),
        }
    }

    /// How many pairs.
    pub(super) fn len(&self) -> usize {
        self.used.len()
    }

    /// The number of a pair, and whether it was met for the first time.
    pub(super) fn number(&mut self, vertex: u32, surface: u32) -> (u32, bool) {
        if 2 * self.used.len() >= self.keys.len() {
            self.grow();
        }
        let key = u64::from(vertex) << 32 | u64::from(surface);
        let place = self.place(key);
        if self.keys[place] == key {
            return (self.slots[place], false);
        }
        let slot = self.used.len() as u32;
        self.keys[place] = key;
        self.slots[place] = slot;
        self.used.push(place as u32);
        (slot, true)
    }

    /// Forgets the pairs, keeps the memory.
    pub(super) fn clear(&mut self) {
        for place in self.used.drain(..) {
            self.keys[place as usize] = EMPTY;
        }
    }

    /// Where a key is, or would go.
    fn place(&self, key: u64) -> usize {
        let mask = self.keys.len() - 1;
        // Fibonacci hashing: the high bits of the product are well mixed.
        let mut place = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.keys[place] != EMPTY && self.keys[place] != key {
            place = (place + 1) & mask;
        }
        place
    }

    fn grow(&mut self) {
        let mut larger = Self::with_places(2 * self.keys.len());
        for place in &self.used {
            let key = self.keys[*place as usize];
            larger.number((key >> 32) as u32, key as u32);
        }
        *self = larger;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_first_meetings_and_survive_growth() {
        let mut map = SlotMap::new();
        for round in 0..2 {
            for i in 0..5000u32 {
                assert_eq!(map.number(i * 7, i % 3), (i, round == 0));
            }
        }
        assert_eq!(map.number(0, 1), (5000, true));
        assert_eq!(map.len(), 5001);
        map.clear();
        assert_eq!(map.number(70, 1), (0, true));
    }
}
