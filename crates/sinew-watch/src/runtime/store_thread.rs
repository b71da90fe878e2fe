//! The thread that stores: nobody waits for it but what it stores.

use super::core_thread::{Control, CoreHandle};
use super::health::Health;
use crate::store::{Store, StoreError};
use sinew_watch_core::Transaction;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Transactions that are stored together, at most: one wait for the disk for all of them.
const TOGETHER: usize = 256;

/// What the store is asked for.
pub enum Request {
    /// Store this; the answer goes to the robot's core.
    Store {
        /// What.
        transaction: Transaction,
        /// Robot's place in its core.
        robot: usize,
        /// Its core.
        core: CoreHandle,
    },
    /// Remember that records are in a file.
    Exported {
        /// Of this type.
        robot_type: String,
        /// Of this month.
        month: String,
        /// In the file of this number.
        number: u32,
        /// Up to this one.
        last_record: i64,
    },
    /// All is stored that was asked for; end.
    End,
}

/// Starts the thread.
///
/// # Errors
/// The system has no thread left.
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
                Request::Exported {
                    robot_type,
                    month,
                    number,
                    last_record,
                } => {
                    // A file that isn't remembered is written again under the same number.
                    let done = store.exported(&robot_type, &month, number, last_record);
                    if let Err(error) = done {
                        health.say(&format!("records of {month}: {}", error.in_words()));
                    }
                }
                Request::End => ends = true,
            }
            next = match transactions.len() < TOGETHER && !ends {
                true => requests.try_recv().ok(),
                false => None,
            };
        }
        if !transactions.is_empty() {
            commit(&mut store, transactions, whose, health);
        }
    }
    // What is in the log beside the database is there as well; this only tidies up.
    let _untidy = store.checkpoint();
}

/// Stores them together; where that fails each on its own, so that one that can't be stored stops no other.
fn commit(
    store: &mut Store,
    transactions: Vec<Transaction>,
    whose: Vec<(usize, CoreHandle)>,
    health: &Health,
) {
    let begun = Instant::now();
    let together = store.commit(&transactions);
    health.committed(transactions.len(), begun.elapsed(), together.as_ref().err());
    let alone = transactions.len() > 1
        && together
            .as_ref()
            .is_err_and(|error| !error.is_of_the_disk());
    for (transaction, (robot, core)) in transactions.into_iter().zip(whose) {
        let result = match (&together, alone) {
            (Ok(()), _) => Ok(()),
            (Err(_), true) => store
                .commit(std::slice::from_ref(&transaction))
                .map_err(|e| e.in_words()),
            (Err(error), false) => Err(StoreError::in_words(error)),
        };
        core.tell(Control::Stored {
            robot,
            transaction: Box::new(transaction),
            result,
        });
    }
}
