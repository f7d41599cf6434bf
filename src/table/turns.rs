//! Pairs of a table in turn on the threads: the bodies of the next one are made beside the places of those that are ready, and no thread waits for
//! the last place of a pair.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use railspring_profiles::error::{Error, Result};
use rayon::ScopeFifo;

/// What is done of each pair.
pub(super) trait Pairs: Sync {
    /// What its places are pressed with.
    type Ready: Send + Sync;
    /// What a place comes to.
    type Place: Send;

    /// How many places each pair has; one at least.
    fn places(&self) -> &[usize];
    /// Makes a pair ready, one at a time and in order.
    fn ready(&self, pair: usize) -> Result<Self::Ready>;
    /// How many pairs may be ready or becoming so at the same time, as this one has room beside it; one at least.
    fn at_once(&self, ready: &Self::Ready) -> usize;
    /// Makes a place of a pair.
    fn place(&self, pair: usize, ready: &Self::Ready, place: usize) -> Result<Self::Place>;
}

/// The places of all pairs, in order. The threads share them as they come; the answer does not depend on how many there are.
///
/// # Errors
/// The first error, after which nothing further is begun.
pub(super) fn in_turn<P: Pairs>(pairs: &P) -> Result<Vec<Vec<P::Place>>> {
    let made = pairs.places().iter().map(|count| (0..*count).map(|_| None).collect()).collect();
    let state = State { next: 0, open: 0, preparing: false, at_once: 1, made, error: None };
    let turns = Turns { pairs, state: Mutex::new(state) };
    rayon::scope_fifo(|scope| turns.begin(scope));
    let State { made, error, .. } = turns.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    error.map_or(Ok(()), Err)?;
    let whole = |places: Vec<Option<P::Place>>| -> Vec<P::Place> {
        places.into_iter().map(|place| place.expect("every place of every pair was made")).collect()
    };
    Ok(made.into_iter().map(whole).collect())
}

/// Pause of a thread that waits for a part of its task, before it looks again.
const PAUSE: Duration = Duration::from_millis(1);

thread_local! {
    /// Whether this thread has a task.
    static AT_WORK: Cell<bool> = const { Cell::new(false) };
}

/// Takes the note of a task away, however that ends.
struct AtWork;

impl Drop for AtWork {
    fn drop(&mut self) {
        AT_WORK.set(false);
    }
}

/// Making a pair ready, or a place.
type Task<'s> = Box<dyn FnOnce(&ScopeFifo<'s>) + Send + 's>;

struct Turns<'p, P: Pairs> {
    pairs: &'p P,
    state: Mutex<State<P::Place>>,
}

struct State<T> {
    /// The pair that is made ready next.
    next: usize,
    /// Pairs that are ready or becoming so, and not done.
    open: usize,
    /// Whether one is becoming ready.
    preparing: bool,
    /// How many may be open.
    at_once: usize,
    /// Places of all pairs.
    made: Vec<Vec<Option<T>>>,
    error: Option<Error>,
}

/// A pair that is ready, and how many of its places are not done.
struct Open<R> {
    pair: usize,
    ready: R,
    left: AtomicUsize,
}

impl<P: Pairs> Turns<'_, P> {
    fn state(&self) -> MutexGuard<'_, State<P::Place>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has the next pair made ready, if there is one and room for it.
    fn begin<'s>(&'s self, scope: &ScopeFifo<'s>) {
        let mut state = self.state();
        let none = state.next == self.pairs.places().len() || state.error.is_some();
        if none || state.preparing || state.open >= state.at_once {
            return;
        }
        let pair = state.next;
        (state.next, state.open, state.preparing) = (pair + 1, state.open + 1, true);
        drop(state);
        self.spawn(scope, Box::new(move |scope| self.prepare(pair, scope)));
    }

    /// Has a task done by a thread that has none. One that waits for a part of its task may be offered another one, which would keep the first one and its
    /// memory waiting.
    fn spawn<'s>(&'s self, scope: &ScopeFifo<'s>, task: Task<'s>) {
        scope.spawn_fifo(move |scope| {
            if AT_WORK.replace(true) {
                std::thread::sleep(PAUSE);
                return self.spawn(scope, task);
            }
            let _at_work = AtWork;
            task(scope);
        });
    }

    fn prepare<'s>(&'s self, pair: usize, scope: &ScopeFifo<'s>) {
        let ready = match self.pairs.ready(pair) {
            Ok(ready) => ready,
            Err(error) => return self.fail(error),
        };
        let mut state = self.state();
        (state.preparing, state.at_once) = (false, self.pairs.at_once(&ready).max(1));
        drop(state);
        let count = self.pairs.places()[pair];
        let open = Arc::new(Open { pair, ready, left: AtomicUsize::new(count) });
        for place in 0..count {
            let open = Arc::clone(&open);
            self.spawn(scope, Box::new(move |scope| self.place(open, place, scope)));
            // the first place takes longest, and the bodies of the next pair are to be there when these places are done
            if place == 0 {
                self.begin(scope);
            }
        }
    }

    fn place<'s>(&'s self, open: Arc<Open<P::Ready>>, place: usize, scope: &ScopeFifo<'s>) {
        if self.state().error.is_some() {
            return;
        }
        match self.pairs.place(open.pair, &open.ready, place) {
            Ok(made) => self.state().made[open.pair][place] = Some(made),
            Err(error) => return self.fail(error),
        }
        if open.left.fetch_sub(1, Ordering::AcqRel) == 1 {
            // before the next pair takes its memory
            drop(open);
            self.state().open -= 1;
            self.begin(scope);
        }
    }

    fn fail(&self, error: Error) {
        self.state().error.get_or_insert(error);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use railspring_profiles::error::InputError;
    use std::sync::Condvar;
    use std::thread::sleep;

    /// Pairs whose places wait, the first of each for long; the last number is the pair that fails.
    struct Waiting {
        places: Vec<usize>,
        at_once: usize,
        fails: Option<usize>,
        /// Pairs that are ready, and the most that were at the same time.
        ready: Mutex<[usize; 2]>,
    }

    const SHORT: Duration = Duration::from_millis(5);
    const LONG: Duration = Duration::from_millis(60);

    thread_local! {
        static PLACE: Cell<bool> = const { Cell::new(false) };
    }

    struct IsReady<'w>(&'w Waiting);

    impl Drop for IsReady<'_> {
        fn drop(&mut self) {
            self.0.ready.lock().unwrap()[0] -= 1;
        }
    }

    impl<'w> Pairs for &'w Waiting {
        type Ready = IsReady<'w>;
        type Place = (usize, usize);

        fn places(&self) -> &[usize] {
            &self.places
        }

        fn ready(&self, pair: usize) -> Result<IsReady<'w>> {
            if self.fails == Some(pair) {
                return Err(InputError::new("pair", pair, "another one", "leave it out").into());
            }
            let mut ready = self.ready.lock().unwrap();
            ready[0] += 1;
            ready[1] = ready[1].max(ready[0]);
            Ok(IsReady(self))
        }

        fn at_once(&self, _: &IsReady<'w>) -> usize {
            self.at_once
        }

        fn place(&self, pair: usize, _: &IsReady<'w>, place: usize) -> Result<(usize, usize)> {
            assert!(!PLACE.replace(true), "a thread has two places at the same time");
            // in two parts, of which another thread may take one
            let part = (if place == 0 { LONG } else { SHORT }) / 2;
            rayon::join(|| sleep(part), || sleep(part));
            PLACE.set(false);
            Ok((pair, place))
        }
    }

    fn waiting(places: &[usize], at_once: usize, fails: Option<usize>) -> Waiting {
        Waiting { places: places.to_vec(), at_once, fails, ready: Mutex::default() }
    }

    fn threads(count: usize) -> rayon::ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap()
    }

    /// Goal: every place once and in order, whatever the threads and the pairs at once; no more pairs are ready than may be, and no thread has two places at the
    /// same time, though parts of places are shared.
    #[test]
    fn every_place_is_made_once() {
        let expected = |places: &[usize]| -> Vec<Vec<(usize, usize)>> {
            let of = |(pair, count): (usize, &usize)| (0..*count).map(|place| (pair, place)).collect();
            places.iter().enumerate().map(of).collect()
        };
        for (count, at_once) in [(1, 1), (1, 2), (2, 1), (2, 2), (4, 3)] {
            for places in [&[][..], &[1], &[3, 1, 2, 5, 1]] {
                let pairs = waiting(places, at_once, None);
                let made = threads(count).install(|| in_turn(&&pairs)).unwrap();
                assert_eq!(made, expected(places), "{count} threads, {at_once} at once");
                let [left, most] = *pairs.ready.lock().unwrap();
                assert!(left == 0 && most <= at_once, "{most} of {at_once}");
            }
        }
    }

    /// Goal: an error ends the rest, which is not made.
    #[test]
    fn an_error_ends_the_rest() {
        let pairs = waiting(&[2, 2, 2, 2], 2, Some(1));
        let error = threads(2).install(|| in_turn(&&pairs)).unwrap_err();
        assert!(error.to_string().contains("pair = 1"), "{error}");
        assert_eq!(*pairs.ready.lock().unwrap(), [0, 1]);
    }

    /// Pairs the first place of which ends when that of the next pair has begun; the last number is how many are open at once.
    struct Linked {
        places: Vec<usize>,
        at_once: usize,
        /// How many first places have begun.
        begun: Mutex<usize>,
        another: Condvar,
    }

    /// Longest that a place waits for another one: milliseconds are enough where it comes at all.
    const PATIENCE: Duration = Duration::from_secs(30);

    impl Pairs for &Linked {
        type Ready = ();
        type Place = ();

        fn places(&self) -> &[usize] {
            &self.places
        }

        fn ready(&self, _: usize) -> Result<()> {
            Ok(())
        }

        fn at_once(&self, (): &()) -> usize {
            self.at_once
        }

        fn place(&self, pair: usize, (): &(), place: usize) -> Result<()> {
            if place > 0 {
                return Ok(());
            }
            let mut begun = self.begun.lock().unwrap();
            *begun += 1;
            self.another.notify_all();
            let next = (pair + 2).min(self.places.len());
            let waited = self.another.wait_timeout_while(begun, PATIENCE, |begun| *begun < next).unwrap();
            match waited.1.timed_out() {
                true => Err(InputError::new("pair", pair, "the next one begun", "wait for no place").into()),
                false => Ok(()),
            }
        }
    }

    /// Goal: two threads do not wait for the long place of a pair while there is another pair: here it ends only when that of the next pair has begun. With one
    /// thread, or one pair at a time, that never happens.
    #[test]
    fn no_thread_waits_for_the_last_place_of_a_pair() {
        let linked = |places: &[usize], at_once: usize| {
            let linked =
                Linked { places: places.to_vec(), at_once, begun: Mutex::default(), another: Condvar::new() };
            threads(2).install(|| in_turn(&&linked)).map(|made| made.len())
        };
        assert_eq!(linked(&[5; 8], 2).unwrap(), 8);
        assert_eq!(linked(&[1, 4, 1, 1, 3], 2).unwrap(), 5);
    }
}
