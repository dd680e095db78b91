//! Arrays filled a run at a time on all threads, without being written twice.

#![allow(unsafe_code)]

use rayon::prelude::*;
use std::mem::MaybeUninit;

/// The places of a run, filled from the first on.
pub(crate) struct Run<'a, T> {
    places: &'a mut [MaybeUninit<T>],
    filled: usize,
}

impl<T> Run<'_, T> {
    /// Elements of the run.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Writes the next element.
    ///
    /// # Panics
    /// If the run is full.
    #[inline(always)]
    pub fn push(&mut self, value: T) {
        self.places[self.filled].write(value);
        self.filled += 1;
    }
}

/// Appends `len` elements to `array`, which has room for them, by `fill`: it is given the number of a run of `run`
/// elements (the last may have fewer), and memory of its thread's that `init` made. Returns its answers, in order.
///
/// # Errors
/// Of one of the runs that failed; the array is then as before.
///
/// # Panics
/// If there is no room, or a run is not full in the end.
pub(crate) fn fill<T: Copy + Send, S, A: Send, E: Send>(
    array: &mut Vec<T>,
    len: usize,
    run: usize,
    init: impl Fn() -> S + Sync + Send,
    fill: impl Fn(&mut S, usize, &mut Run<'_, T>) -> Result<A, E> + Sync + Send,
) -> Result<Vec<A>, E> {
    let all = array.len() + len;
    let places = &mut array.spare_capacity_mut()[..len];
    let runs = places.par_chunks_mut(run).enumerate().map_init(init, |memory, (number, places)| {
        let mut run = Run { places, filled: 0 };
        let answer = fill(memory, number, &mut run)?;
        assert_eq!(run.filled, run.len(), "a run is filled");
        Ok(answer)
    });
    let answers = runs.collect::<Result<_, E>>()?;
    // SAFETY: there is room for so many, as the slice above shows; every run was full, or this is not reached.
    unsafe { array.set_len(all) };
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_follow_each_other() {
        for len in [0, 1, 9, 10, 11, 1000] {
            let mut array = vec![77];
            array.reserve(len);
            let answers = fill(
                &mut array,
                len,
                10,
                || (),
                |(), number, run| {
                    (0..run.len()).for_each(|i| run.push(10 * number + i));
                    Ok::<_, ()>(number)
                },
            );
            assert_eq!(array, [77].into_iter().chain(0..len).collect::<Vec<_>>());
            assert_eq!(answers.unwrap(), (0..len.div_ceil(10)).collect::<Vec<_>>());
        }
        let mut array = Vec::with_capacity(100);
        let failed = fill(
            &mut array,
            100,
            10,
            || (),
            |(), number, run| {
                (0..run.len()).for_each(|_| run.push(1));
                if number == 7 { Err("seven") } else { Ok(()) }
            },
        );
        assert_eq!((failed, array.len()), (Err("seven"), 0));
    }

    #[test]
    #[should_panic(expected = "a run is filled")]
    fn a_run_with_holes_is_none() {
        let _ = fill(&mut Vec::<u8>::with_capacity(20), 20, 10, || (), |(), _, _| Ok::<_, ()>(()));
    }
}
