//! Who asks a server: connections and what they are waited for. A connection is a stranger until its first request was read whole,
//! then it is asking or idle. Each wait has a deadline and each state a bound; where one is full, whoever waits there longest gives
//! way to whoever comes, so that silent and slow clients, however many, keep no honest one out.

mod caller;
mod connection;
mod places;
mod sending;

pub use caller::{Asking, Caller, Callers, Limits, Wait};
pub use connection::{Connection, listen};
pub use places::{Ending, Place, Places};
pub use sending::Sending;
