//! Callers of a server: connections and their deadlines. A connection is a stranger until its first request was read
//! whole, then it is asking or idle. Each wait has a deadline and each state a bound. Where a state is full, the one
//! that has waited there longest is ended to make room for the newcomer, so that silent and slow clients, however many,
//! keep no honest one out.

mod caller;
mod connection;
mod places;
mod sending;

pub use caller::{Asking, Caller, CallerLimits, Callers, Wait};
pub use connection::{Connection, listen};
pub use places::{CallerPlace, Ending, Places};
pub use sending::Sending;
