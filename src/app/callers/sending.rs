//! An answer on its way out.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};

use crate::caller::Asking;
use crate::places::CallerPlace;

/// Longest piece, bytes. A body in one piece would be taken over at once, and the server could not tell whether it was
/// sent.
const PIECE: usize = 64 << 10;

/// The body of an answer, piece by piece. Holds its places until it is sent but for the last pieces.
#[derive(Debug)]
pub struct Sending<B> {
    body: B,
    /// Unsent rest of the piece that the body gave last.
    rest: Bytes,
    /// (the place first: it must be free before the connection idles)
    _place: Option<CallerPlace>,
    _asking: Option<Arc<Asking>>,
}

impl<B> Sending<B> {
    /// The answer to a request.
    pub fn new(body: B, asking: Arc<Asking>) -> Self {
        Self {
            body,
            rest: Bytes::new(),
            _place: Some(asking.sending()),
            _asking: Some(asking),
        }
    }

    /// A short answer that holds no place.
    pub fn short(body: B) -> Self {
        Self {
            body,
            rest: Bytes::new(),
            _place: None,
            _asking: None,
        }
    }
}

impl<B: Body<Data = Bytes> + Unpin> Body for Sending<B> {
    type Data = Bytes;
    type Error = B::Error;

    fn poll_frame(self: Pin<&mut Self>, c: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, B::Error>>> {
        let this = self.get_mut();
        if this.rest.is_empty() {
            let frame = match ready!(Pin::new(&mut this.body).poll_frame(c)) {
                Some(Ok(frame)) => frame,
                other => return Poll::Ready(other),
            };
            match frame.into_data() {
                Ok(data) if data.len() > PIECE => this.rest = data,
                Ok(data) => return Poll::Ready(Some(Ok(Frame::data(data)))),
                Err(other) => return Poll::Ready(Some(Ok(other))),
            }
        }
        let piece = this.rest.split_to(this.rest.len().min(PIECE));
        Poll::Ready(Some(Ok(Frame::data(piece))))
    }

    fn is_end_stream(&self) -> bool {
        self.rest.is_empty() && self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        let (of_body, rest) = (self.body.size_hint(), self.rest.len() as u64);
        let mut hint = SizeHint::new();
        hint.set_lower(of_body.lower() + rest);
        if let Some(upper) = of_body.upper() {
            hint.set_upper(upper + rest);
        }
        hint
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body of one piece.
    struct Whole(Option<Bytes>);

    impl Body for Whole {
        type Data = Bytes;
        type Error = std::convert::Infallible;

        fn poll_frame(
            self: Pin<&mut Self>,
            _: &mut Context<'_>,
        ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
            Poll::Ready(self.get_mut().0.take().map(|b| Ok(Frame::data(b))))
        }

        fn is_end_stream(&self) -> bool {
            self.0.is_none()
        }

        fn size_hint(&self) -> SizeHint {
            SizeHint::with_exact(self.0.as_ref().map_or(0, |b| b.len() as u64))
        }
    }

    #[test]
    fn a_long_body_goes_out_in_pieces_and_is_the_same() {
        let bytes: Vec<u8> = (0..3 * PIECE + 7).map(|i| i as u8).collect();
        let mut body = Sending::short(Whole(Some(bytes.clone().into())));
        let (mut out, mut pieces) = (Vec::new(), 0);
        let mut c = Context::from_waker(std::task::Waker::noop());
        loop {
            let left = (bytes.len() - out.len()) as u64;
            assert_eq!(body.size_hint().exact(), Some(left));
            assert_eq!(body.is_end_stream(), left == 0);
            let Poll::Ready(Some(frame)) = Pin::new(&mut body).poll_frame(&mut c) else {
                break;
            };
            let data = frame.expect("no error").into_data().expect("data");
            assert!(data.len() <= PIECE);
            out.extend_from_slice(&data);
            pieces += 1;
        }
        assert_eq!(pieces, 4);
        assert!(out == bytes);
    }
}
