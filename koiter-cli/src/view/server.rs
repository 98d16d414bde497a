//! Connections: how many at once, and for how long.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use super::http::{Answer, Request, read_request};

/// Most connections at once; a browser opens six to one server.
const MAX_CONNECTIONS: usize = 32;
/// Within this time a request must have come.
const REQUEST_TIME: Duration = Duration::from_secs(5);
/// Within this time an answer must be taken, however large.
const ANSWER_TIME: Duration = Duration::from_secs(60);
/// What is still sent after an answer was given early is thrown away, up to this many bytes and this long, so that the
/// answer is not lost with the connection.
const REST: (u64, Duration) = (1 << 20, Duration::from_millis(500));

/// Answers connections until the process ends.
pub(super) fn serve<F>(listener: &TcpListener, answer: F)
where
    F: Fn(&Request) -> Answer + Send + Sync + 'static,
{
    let (answer, open) = (Arc::new(answer), Arc::new(AtomicUsize::new(0)));
    for stream in listener.incoming() {
        // A connection that failed before it was taken is none.
        let Ok(stream) = stream else { continue };
        let Some(place) = Place::take(&open) else {
            turn_away(&stream);
            continue;
        };
        let answer = answer.clone();
        std::thread::spawn(move || {
            // Who went away misses nothing.
            let _ = attend(&stream, &*answer);
            drop(place);
        });
    }
}

/// One of the connections that are open.
struct Place(Arc<AtomicUsize>);

impl Place {
    fn take(open: &Arc<AtomicUsize>) -> Option<Self> {
        // Only the thread that accepts adds.
        let is_free = open.load(Ordering::SeqCst) < MAX_CONNECTIONS;
        is_free.then(|| {
            open.fetch_add(1, Ordering::SeqCst);
            Self(open.clone())
        })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Says that there is no place, as far as that can be said without waiting.
fn turn_away(mut stream: &TcpStream) {
    if stream.set_nonblocking(true).is_ok() {
        let _ = Answer::error(503, "too many connections at once").write(&mut stream);
    }
}

fn attend(stream: &TcpStream, answer: &dyn Fn(&Request) -> Answer) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let given = match read_request(&mut Timed::new(stream, REQUEST_TIME)) {
        Ok(request) => Some(answer(&request)),
        Err(refusal) => refusal,
    };
    if let Some(given) = given {
        given.write(&mut Timed::new(stream, ANSWER_TIME))?;
    }
    stream.shutdown(Shutdown::Write)?;
    let mut rest = Timed::new(stream, REST.1).take(REST.0);
    io::copy(&mut rest, &mut io::sink()).map(drop)
}

/// A stream that all reading and writing together has so much time for: a byte now and then does not keep it open.
struct Timed<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl<'a> Timed<'a> {
    fn new(stream: &'a TcpStream, time: Duration) -> Self {
        Self {
            stream,
            end: Instant::now() + time,
        }
    }

    fn left(&self) -> io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        // Zero would mean without end.
        match left.is_zero() {
            true => Err(io::ErrorKind::TimedOut.into()),
            false => Ok(left),
        }
    }
}

impl Read for Timed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(buffer)
    }
}

impl Write for Timed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
