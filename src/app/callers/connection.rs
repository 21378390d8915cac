//! Connections as a server reads and writes them, each until its caller is told to end.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use socket2::{Domain, Socket, Type};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};

use crate::caller::{Caller, Callers};

/// Connections that the system keeps until they are taken: more than come in one burst.
const BACKLOG: i32 = 4096;
/// Wait after no connection could be taken.
const AGAIN: Duration = Duration::from_millis(10);

/// Takes an address, to be listened on within a tokio runtime. Errors if it cannot be had.
pub fn listen(at: SocketAddr) -> io::Result<std::net::TcpListener> {
    let socket = Socket::new(Domain::for_address(at), Type::STREAM, None)?;
    // (as the standard library does: elsewhere it would take an address that is in use)
    if cfg!(unix) {
        socket.set_reuse_address(true)?;
    }
    socket.bind(&at.into())?;
    socket.listen(BACKLOG)?;
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}

impl Callers {
    /// The next connection. Takes all that come: the longest silent one makes room.
    pub async fn accept(&self, listener: &TcpListener) -> Connection {
        loop {
            match listener.accept().await {
                Ok((stream, _)) => {
                    // (slower without, and no error)
                    let _ = stream.set_nodelay(true);
                    // Requests on the connections taken before are read before the next connection is taken.
                    tokio::task::yield_now().await;
                    return Connection::new(stream, self.connected());
                }
                Err(_) => {
                    // No file handle is left, or the client went.
                    self.make_room();
                    tokio::time::sleep(AGAIN).await;
                }
            }
        }
    }
}

/// A connection of a caller.
pub struct Connection {
    stream: TcpStream,
    caller: Arc<Caller>,
    told: Pin<Box<dyn Future<Output = ()> + Send>>,
}

impl Connection {
    fn new(stream: TcpStream, caller: Arc<Caller>) -> Self {
        Self {
            stream,
            told: Box::pin(caller.ending().told()),
            caller,
        }
    }

    /// The caller of this connection.
    pub fn caller(&self) -> &Arc<Caller> {
        &self.caller
    }

    /// Its stream; an error once it was told to end.
    fn open(&mut self, c: &mut Context<'_>) -> io::Result<Pin<&mut TcpStream>> {
        if self.caller.ending().is_told() || self.told.as_mut().poll(c).is_ready() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        Ok(Pin::new(&mut self.stream))
    }
}

impl AsyncRead for Connection {
    fn poll_read(self: Pin<&mut Self>, c: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        self.get_mut().open(c)?.poll_read(c, into)
    }
}

impl AsyncWrite for Connection {
    fn poll_write(self: Pin<&mut Self>, c: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.get_mut().open(c)?.poll_write(c, bytes)
    }

    fn poll_flush(self: Pin<&mut Self>, c: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.get_mut().open(c)?.poll_flush(c)
    }

    fn poll_shutdown(self: Pin<&mut Self>, c: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_shutdown(c)
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        c: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.get_mut().open(c)?.poll_write_vectored(c, bytes)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
