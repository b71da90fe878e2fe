//! Sequence in bounded memory.

/// Maximum number of elements: five and a half hours of blocks of 0.2 s.
const MAX_ELEMENTS: usize = 100_000;

/// Every `stride`-th element of a sequence; the stride doubles when the number of elements exceeds the limit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Decimated<T> {
    elements: Vec<T>,
    stride: usize,
    /// Number of elements since the last one that was kept.
    skipped: usize,
}

impl<T> Default for Decimated<T> {
    fn default() -> Self {
        Self {
            elements: Vec::new(),
            stride: 1,
            skipped: 0,
        }
    }
}

impl<T> Decimated<T> {
    /// Adds the next element.
    pub(crate) fn push(&mut self, element: T) {
        self.skipped += 1;
        if !self.elements.is_empty() && self.skipped < self.stride {
            return;
        }
        self.skipped = 0;
        if self.elements.len() >= MAX_ELEMENTS {
            let mut k = 0;
            self.elements.retain(|_| {
                k += 1;
                k % 2 == 1
            });
            self.stride *= 2;
        }
        self.elements.push(element);
    }

    /// Returns the elements.
    pub(crate) fn into_vec(self) -> Vec<T> {
        self.elements
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sequence_is_evenly_spaced_and_bounded() {
        let mut all = Decimated::default();
        for k in 0..5 * MAX_ELEMENTS {
            all.push(k);
        }
        let kept = all.into_vec();
        assert!(kept.len() <= MAX_ELEMENTS && kept.len() > MAX_ELEMENTS / 4);
        let steps: Vec<usize> = kept.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(
            steps.iter().all(|step| *step == steps[0]),
            "{:?}",
            &steps[..9]
        );
    }
}
