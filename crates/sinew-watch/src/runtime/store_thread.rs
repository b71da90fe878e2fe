//! Thread that writes to the store.

use super::health::Health;
use super::messages::{Control, CoreHandle, NotStored, Request};
use crate::store::Store;
use crate::words;
use sinew_watch_core::Transaction;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Maximum number of transactions stored together with one synchronisation of the disk.
const MAX_TRANSACTIONS: usize = 256;

/// Starts the thread.
///
/// # Errors
/// Returns the error of the system if the thread cannot be started.
pub(super) fn start(
    store: Store,
    health: Arc<Health>,
) -> std::io::Result<(Sender<Request>, JoinHandle<()>)> {
    let (sender, receiver) = channel();
    let thread = std::thread::Builder::new()
        .name("store".into())
        .spawn(move || run(store, &receiver, &health))?;
    Ok((sender, thread))
}

fn run(mut store: Store, requests: &Receiver<Request>, health: &Health) {
    let mut ends = false;
    while !ends {
        let Ok(first) = requests.recv() else { break };
        let mut transactions = Vec::new();
        let mut whose = Vec::new();
        let mut next = Some(first);
        while let Some(request) = next {
            match request {
                Request::Store {
                    transaction,
                    robot,
                    core,
                } => {
                    transactions.push(transaction);
                    whose.push((robot, core));
                }
                Request::Exported(written) => {
                    // A file that is not recorded is written again under the same number.
                    if let Err(error) = store.exported(&written) {
                        let month = written.month;
                        health.log(&words::log::export_not_recorded(&month, &error.in_words()));
                    }
                }
                Request::Thin {
                    robot,
                    before_utc_s,
                } => {
                    // Repeated an hour later.
                    if let Err(error) = store.thin(&robot, before_utc_s) {
                        health.log(&words::log::not_thinned(&robot, &error.in_words()));
                    }
                }
                Request::End => ends = true,
            }
            next = match transactions.len() < MAX_TRANSACTIONS && !ends {
                true => requests.try_recv().ok(),
                false => None,
            };
        }
        if !transactions.is_empty() {
            commit(&mut store, transactions, whose, health);
        }
    }
    // The write-ahead log contains the same data; this only shortens it.
    let _untidy = store.checkpoint();
}

/// Stores transactions together; after a failure each separately, so that an invalid one does not block the others.
fn commit(
    store: &mut Store,
    transactions: Vec<Transaction>,
    whose: Vec<(usize, CoreHandle)>,
    health: &Health,
) {
    let begun = Instant::now();
    let together = store.commit(&transactions);
    let alone = transactions.len() > 1
        && together
            .as_ref()
            .is_err_and(|error| !error.is_of_the_disk());
    if !alone {
        health.committed(transactions.len(), begun.elapsed(), together.as_ref().err());
    }
    for (transaction, (robot, core)) in transactions.into_iter().zip(whose) {
        let result = match (&together, alone) {
            (Ok(()), _) => Ok(()),
            (Err(_), true) => {
                let begun = Instant::now();
                let own = store.commit(std::slice::from_ref(&transaction));
                match &own {
                    Ok(()) => health.committed(1, begun.elapsed(), None),
                    Err(error) if error.is_of_the_disk() => {
                        health.committed(1, begun.elapsed(), Some(error));
                    }
                    // This transaction is invalid; the store works.
                    Err(error) => health.transaction_rejected(&transaction.robot, error),
                }
                own.map_err(|e| NotStored::of(&e))
            }
            (Err(error), false) => Err(NotStored::of(error)),
        };
        core.send(Control::Stored {
            robot,
            transaction: Box::new(transaction),
            result,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Place;
    use sinew_transport::Inbox;
    use sinew_watch_core::journal::{Entry, Event};

    fn of(robot: &str, time_utc_s: f64) -> Transaction {
        Transaction {
            id: 1,
            robot: robot.into(),
            records: Vec::new(),
            replaced_from_utc_s: None,
            state: None,
            alarms: None,
            journal: vec![Entry {
                time_utc_s,
                event: Event::Silent,
            }],
        }
    }

    #[test]
    fn commit_invalid_transaction_leaves_store_working() {
        let mut store = Store::open(Place::Memory(7_000_001)).unwrap();
        let health = Health::new(1);
        let (core, answers) = CoreHandle::new(Inbox::new());
        // SQLite stores a NaN as NULL, which the column rejects.
        let three = vec![of("a", 1.0), of("b", f64::NAN), of("c", 1.0)];
        let whose = (0..3).map(|robot| (robot, core.clone())).collect();
        commit(&mut store, three, whose, &health);
        let stored: Vec<bool> = answers
            .try_iter()
            .map(|answer| matches!(answer, Control::Stored { result: Ok(()), .. }))
            .collect();
        assert_eq!(stored, [true, false, true]);
        assert_eq!(health.store_fails(), None, "the store works");
        let count =
            |of: &std::sync::atomic::AtomicU64| of.load(std::sync::atomic::Ordering::Relaxed);
        assert_eq!(
            (
                count(&health.counts.transactions),
                count(&health.counts.failures)
            ),
            (2, 1)
        );
    }
}
