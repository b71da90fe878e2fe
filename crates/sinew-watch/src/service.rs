//! The program while it runs: signals, the web's thread, systemd, and files of records at the end of a month.

use crate::config::{Config, WebSettings, Webhook};
use crate::notify::{notify, watchdog};
use crate::runtime::{Runtime, Start, StartError};
use crate::store::Place;
use crate::web::guard::Guard;
use crate::web::{self, App, Ticker, routes};
use crate::{token, webhooks};
use sinew_watch_core::journal::Entry;
use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};

/// The program looks round so often.
const ROUND: Duration = Duration::from_millis(500);
/// Browsers are told so often.
const TICK: Duration = Duration::from_secs(1);
/// systemd is told that the program is alive as long as every core thread goes round at least so often.
const HANGS_AFTER: Duration = Duration::from_secs(10);

/// What the program is told while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Read the configuration again.
    Reload,
    /// End the program.
    End,
}

/// What the web's thread needs.
pub struct WebStart {
    /// Address and rules; `None`: no page.
    pub settings: WebSettings,
    /// The token, where one is needed.
    pub token: Option<String>,
    /// What the demonstration is.
    pub demo: Option<String>,
    /// Where the store is.
    pub place: Place,
    /// Who is told of alarms.
    pub webhooks: watch::Receiver<Vec<Webhook>>,
    /// Steps of alarms.
    pub steps: mpsc::Receiver<(String, Entry)>,
}

/// The web's thread: page, API, webhooks and signals.
pub struct Web {
    /// Where the page is.
    pub address: Option<SocketAddr>,
    ends: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Web {
    /// Starts it; signals go to `signals`.
    ///
    /// # Errors
    /// The address can't be had, in words.
    pub fn start(
        start: WebStart,
        runtime: &Runtime,
        signals: Sender<Signal>,
    ) -> Result<Self, String> {
        let listener = start.settings.bind.map(|bind| {
            let refuse = |e: std::io::Error| {
                format!("{bind}: can't listen there: {e}; [web] bind names another address")
            };
            let listener = TcpListener::bind(bind).map_err(refuse)?;
            listener.set_nonblocking(true).map_err(refuse)?;
            Ok::<_, String>(listener)
        });
        let listener = listener.transpose()?;
        let address = listener.as_ref().and_then(|l| l.local_addr().ok());
        let (board, health) = (Arc::clone(runtime.board()), Arc::clone(runtime.health()));
        let (clock, pace) = (runtime.clock(), runtime.pace());
        let (ends, ended) = watch::channel(false);
        let tokio = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(16)
            .build();
        let tokio = tokio.map_err(|e| e.to_string())?;
        let work = async move {
            signals_of_the_system(signals);
            tokio::spawn(webhooks::run(
                start.steps,
                start.webhooks,
                Arc::clone(&health),
            ));
            let mut ticker = Ticker::new(Arc::clone(&board), Arc::clone(&health), start.demo);
            let now = move || pace.instant(clock.now()).utc_s();
            let (tell, ticks) = watch::channel(Arc::new(ticker.tick(now())));
            let guard = Guard::new(&start.settings, start.token);
            let app = App::new((board, health), guard, ticks, start.place);
            let mut ended_too = ended.clone();
            if let Some(listener) = listener
                && let Ok(listener) = tokio::net::TcpListener::from_std(listener)
            {
                tokio::spawn(web::serve(listener, routes::router(app), ended));
            }
            let mut every = tokio::time::interval(TICK);
            every.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
            loop {
                tokio::select! {
                    _ = every.tick() => {
                        tell.send_replace(Arc::new(ticker.tick(now())));
                    }
                    _ = ended_too.wait_for(|ends| *ends) => return,
                }
            }
        };
        let thread = std::thread::Builder::new().name("web".into());
        let thread = thread.spawn(move || tokio.block_on(work));
        Ok(Self {
            address,
            ends,
            thread: thread.map_err(|e| e.to_string())?,
        })
    }

    /// Ends the thread.
    pub fn end(self) {
        self.ends.send_replace(true);
        let _panicked = self.thread.join();
    }
}

#[cfg(unix)]
fn signals_of_the_system(signals: Sender<Signal>) {
    use tokio::signal::unix::{SignalKind, signal};
    for (kind, meaning) in [
        (SignalKind::terminate(), Signal::End),
        (SignalKind::interrupt(), Signal::End),
        (SignalKind::hangup(), Signal::Reload),
    ] {
        let signals = signals.clone();
        if let Ok(mut stream) = signal(kind) {
            tokio::spawn(async move {
                while stream.recv().await.is_some() {
                    if signals.send(meaning).is_err() {
                        return;
                    }
                }
            });
        }
    }
}

#[cfg(not(unix))]
fn signals_of_the_system(signals: Sender<Signal>) {
    tokio::spawn(async move {
        while tokio::signal::ctrl_c().await.is_ok() {
            if signals.send(Signal::End).is_err() {
                return;
            }
        }
    });
}

/// Watches what a configuration asks for, until it is told to end.
///
/// # Errors
/// Why it didn't begin, in words.
pub fn run(file: &Path) -> Result<(), String> {
    let mut config = Config::read(file).map_err(|e| e.to_string())?;
    let place = Place::Folder(config.store.clone());
    let (mut runtime, steps) =
        Runtime::new(Start::at(place.clone())).map_err(|e: StartError| e.to_string())?;
    let token = match config.web.needs_token() {
        true => {
            let path = token::place(&config.web, &config.store);
            let token = token::read_or_make(&path)?;
            runtime
                .health()
                .say(&format!("the page needs the token in {}", path.display()));
            Some(token)
        }
        false => None,
    };
    runtime.configure(&config);
    let (hooks, wanted) = watch::channel(config.webhooks.clone());
    let (signals, told) = channel();
    let web = WebStart {
        settings: config.web.clone(),
        token,
        demo: None,
        place: place.clone(),
        webhooks: wanted,
        steps,
    };
    let web = Web::start(web, &runtime, signals)?;
    if let Some(address) = web.address {
        runtime.health().say(&format!("http://{address}"));
    }
    notify("READY=1");
    let mut exports = crate::months::Months::new(&place);
    until_told(&told, &mut runtime, |runtime, signal| {
        if signal == Some(Signal::Reload) {
            reload(file, &mut config, runtime, &hooks);
        }
        exports.look(runtime);
    });
    notify("STOPPING=1");
    runtime.end();
    web.end();
    Ok(())
}

/// Goes round until it is told to end; `each` is called at every round, with what it was told.
pub fn until_told(
    told: &Receiver<Signal>,
    runtime: &mut Runtime,
    mut each: impl FnMut(&mut Runtime, Option<Signal>),
) {
    let watchdog = watchdog();
    let round = watchdog.map_or(ROUND, |every| every.min(ROUND));
    let mut fed = Instant::now();
    loop {
        match told.recv_timeout(round) {
            Ok(Signal::End) | Err(RecvTimeoutError::Disconnected) => return,
            Ok(signal) => each(runtime, Some(signal)),
            Err(RecvTimeoutError::Timeout) => each(runtime, None),
        }
        runtime.look();
        let alive = runtime.health().silent_for() < HANGS_AFTER;
        if let Some(every) = watchdog
            && alive
            && fed.elapsed() >= every
        {
            notify("WATCHDOG=1");
            fed = Instant::now();
        }
    }
}

/// Reads the configuration again; one that is wrong changes nothing.
fn reload(
    file: &Path,
    config: &mut Config,
    runtime: &mut Runtime,
    hooks: &watch::Sender<Vec<Webhook>>,
) {
    notify("RELOADING=1");
    match Config::read(file) {
        Err(error) => runtime.health().say(&format!("not reloaded: {error}")),
        Ok(next) => {
            let kept: Vec<&str> = [
                (next.web != config.web, "[web]"),
                (next.store != config.store, "[store]"),
            ]
            .iter()
            .filter_map(|(differs, name)| differs.then_some(*name))
            .collect();
            if !kept.is_empty() {
                let names = kept.join(" and ");
                runtime
                    .health()
                    .say(&format!("{names} stays as it was until the next start"));
            }
            runtime.configure(&next);
            hooks.send_replace(next.webhooks.clone());
            let (web, store) = (config.web.clone(), config.store.clone());
            *config = Config { web, store, ..next };
            runtime.health().say("the configuration was read again");
        }
    }
    notify("READY=1");
}
