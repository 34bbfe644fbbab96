//! The server: the page, and the way of a question to a process and of its answer back.

mod folder;
mod guard;
mod pages;
mod route;
mod secret;
mod work;

pub use guard::Access;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use route::Router;
use std::collections::HashMap;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

/// How often the server checks whether to stop.
const PAUSE: Duration = Duration::from_millis(50);
/// A client that has asked nothing after this is no longer waited for.
const HEAD: Duration = Duration::from_secs(15);

/// What a question may take.
#[derive(Clone, Copy, Debug)]
pub struct QuestionLimits {
    /// The time limit of a question that the page asks while the user writes.
    pub cheap: Duration,
    /// The time limit of one that the user asks by a button.
    pub dear: Duration,
    /// Memory of its process, in bytes.
    pub memory: u64,
    /// The length of a question, in bytes: a text, or a recording.
    pub question: usize,
    /// Questions that wait or are answered, of all clients and of one: one more is refused.
    pub places: [usize; 2],
    /// Connections at once, of all clients and of one: one more is closed.
    pub connections: [usize; 2],
    /// Questions that are answered at once, of all clients and of one.
    pub at_once: [usize; 2],
}

/// What is served, and to whom.
#[derive(Clone, Debug)]
pub struct LabOptions {
    /// Where it listens; port 0 is any free one.
    pub address: SocketAddr,
    /// Who may ask.
    pub access: Access,
    /// The folder whose files may be read, and written where the page says so; or a file in it, with which the page begins.
    pub folder: Option<PathBuf>,
    /// What one question may take.
    pub limits: QuestionLimits,
    /// The program that answers, with the arguments before the limits.
    pub program: (PathBuf, Vec<String>),
}

/// Why the lab does not start.
#[derive(Debug)]
pub enum LabError {
    /// The address cannot be listened on.
    Address(SocketAddr, std::io::Error),
    /// The folder cannot be read.
    Folder(PathBuf, std::io::Error),
    /// The system gives no threads.
    Threads(std::io::Error),
}

/// A lab that listens and has not begun to answer.
pub struct LabServer {
    runtime: tokio::runtime::Runtime,
    listener: TcpListener,
    router: Arc<Router>,
    address: SocketAddr,
}

impl LabServer {
    /// Begins to listen.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn new(options: LabOptions) -> Result<LabServer, LabError> {
        let LabOptions { address, access, folder, limits, program } = options;
        let (folder, file) = match folder {
            None => (None, None),
            Some(given) => {
                let of_file = || {
                    // a link names what lies elsewhere
                    let is_proof = given.extension().is_some_and(|end| end == "proof");
                    if !is_proof || given.is_symlink() {
                        let why = "it is no folder, and no file whose name ends with .proof";
                        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, why));
                    }
                    let name = given.file_name().map(|name| name.to_string_lossy().into_owned());
                    let parent = given.parent().filter(|parent| !parent.as_os_str().is_empty());
                    Ok((Some(parent.unwrap_or(Path::new(".")).canonicalize()?), name))
                };
                let found = match given.is_file() {
                    true => of_file(),
                    false => given
                        .canonicalize()
                        .and_then(|real| std::fs::read_dir(&real).map(|_| (Some(real), None))),
                };
                found.map_err(|why| LabError::Folder(given, why))?
            }
        };
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
        let runtime = runtime.map_err(LabError::Threads)?;
        let listener = runtime.block_on(TcpListener::bind(address));
        let listener = listener.map_err(|why| LabError::Address(address, why))?;
        let address = listener.local_addr().map_err(|why| LabError::Address(address, why))?;
        let router = Arc::new(Router::new(access, address, (folder, file), limits, program));
        Ok(LabServer { runtime, listener, router, address })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Answers until `stop` says so. Questions that are not answered by then are ended.
    pub fn run(self, stop: &dyn Fn() -> bool) {
        let LabServer { runtime, listener, router, .. } = self;
        runtime.block_on(async {
            let [of_all, of_one] = router.connections();
            let connections = Arc::new(Semaphore::new(of_all));
            let clients: Arc<Mutex<HashMap<IpAddr, usize>>> = Arc::default();
            while !stop() {
                let Ok(accepted) = tokio::time::timeout(PAUSE, listener.accept()).await else { continue };
                // too many files are open, or the other end has gone: both pass
                let Ok((stream, client)) = accepted else {
                    tokio::time::sleep(PAUSE).await;
                    continue;
                };
                // one more is closed at once
                let Ok(permit) = connections.clone().try_acquire_owned() else { continue };
                let Some(one) = OfClient::new(&clients, client.ip(), of_one) else { continue };
                let router = router.clone();
                let longest = router.longest();
                tokio::spawn(async move {
                    let service = hyper::service::service_fn(move |request| {
                        let router = router.clone();
                        async move {
                            Ok::<_, std::convert::Infallible>(router.respond(request, client.ip()).await)
                        }
                    });
                    let mut server = http1::Builder::new();
                    server.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(64 << 10);
                    let mut connection = pin!(server.serve_connection(TokioIo::new(stream), service));
                    // one that is old ends with its answer, and one that takes none of it does not stay
                    let is_old = tokio::time::timeout(longest, connection.as_mut()).await.is_err();
                    if is_old {
                        connection.as_mut().graceful_shutdown();
                        let _ = tokio::time::timeout(longest, connection).await;
                    }
                    drop((permit, one));
                });
            }
        });
        runtime.shutdown_timeout(PAUSE);
    }
}

type Clients = Arc<Mutex<HashMap<IpAddr, usize>>>;

/// A connection among those of its client.
struct OfClient {
    clients: Clients,
    client: IpAddr,
}

impl OfClient {
    /// One more of a client; none where it has so many.
    fn new(clients: &Clients, client: IpAddr, most: usize) -> Option<OfClient> {
        let mut counts = clients.lock().unwrap_or_else(PoisonError::into_inner);
        let count = counts.entry(client).or_default();
        if *count >= most {
            return None;
        }
        *count += 1;
        Some(OfClient { clients: clients.clone(), client })
    }
}

impl Drop for OfClient {
    fn drop(&mut self) {
        let mut counts = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        let left = counts.get_mut(&self.client).map(|count| {
            *count -= 1;
            *count
        });
        if left == Some(0) {
            counts.remove(&self.client);
        }
    }
}
