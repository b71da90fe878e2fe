//! Running program: signals, web thread, systemd notification, and monthly record files.

use crate::config::{Config, MqttSettings, Receiver as NotificationReceiver, WebSettings};
use crate::notify::{notify, watchdog};
use crate::runtime::{Runtime, Start, StartError};
use crate::store::Place;
use crate::token::{self, Token};
use crate::web::guard::Guard;
use crate::web::{self, App, Ticker, routes};
use crate::{mqtt, webhooks, words};
use sinew_watch_core::journal::Entry;
use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};

/// Duration of one loop of the program.
const LOOP_TIME: Duration = Duration::from_millis(500);
/// Interval of updates to browsers.
const TICK: Duration = Duration::from_secs(1);
/// Maximum time since the last loop of a core thread for which systemd is notified that the program is alive.
const MAX_LOOP_AGE: Duration = Duration::from_secs(10);

/// Signal to the running program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Reload the configuration.
    Reload,
    /// Stop the program.
    End,
}

/// Parameters of the web thread.
pub struct WebStart {
    /// Address and access control; `None`: no page.
    pub settings: WebSettings,
    /// Access tokens; empty: none is required.
    pub tokens: Vec<Token>,
    /// Description of the demonstration; `None`: real robots.
    pub demo: Option<String>,
    /// Location of the store.
    pub place: Place,
    /// Receivers of alarm notifications.
    pub receivers: watch::Receiver<Vec<NotificationReceiver>>,
    /// Broker to which the states of the tendons are published; `None`: none.
    pub mqtt: Option<MqttSettings>,
    /// Receiver of alarm transitions.
    pub steps: mpsc::Receiver<(String, Entry)>,
}

/// Web thread with page, API, notifications and signals.
pub struct Web {
    /// Address of the page.
    pub address: Option<SocketAddr>,
    ends: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Web {
    /// Starts the thread; signals go to `signals`.
    ///
    /// # Errors
    /// Returns the reason as text if the address cannot be used.
    pub fn start(
        start: WebStart,
        runtime: &Runtime,
        signals: Sender<Signal>,
    ) -> Result<Self, String> {
        let listener = start.settings.bind.map(|bind| {
            let error = |e: std::io::Error| {
                format!("{bind}: cannot listen: {e}; set another address in [web] bind")
            };
            let listener = TcpListener::bind(bind).map_err(error)?;
            listener.set_nonblocking(true).map_err(error)?;
            Ok::<_, String>(listener)
        });
        let listener = listener.transpose()?;
        let address = listener.as_ref().and_then(|l| l.local_addr().ok());
        let (registry, health) = (Arc::clone(runtime.registry()), Arc::clone(runtime.health()));
        let (clock, clock_rate) = (runtime.clock(), runtime.clock_rate());
        let (ends, ended) = watch::channel(false);
        let tokio = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(16)
            .build();
        let tokio = tokio.map_err(|e| e.to_string())?;
        let receivers = start.receivers.clone();
        let work = async move {
            signals_of_the_system(signals);
            tokio::spawn(webhooks::run(
                start.steps,
                start.receivers,
                Arc::clone(&health),
            ));
            if let Some(settings) = start.mqtt {
                let (registry, health) = (Arc::clone(&registry), Arc::clone(&health));
                tokio::spawn(mqtt::run(settings, registry, health));
            }
            let mut ticker = Ticker::new(Arc::clone(&registry), Arc::clone(&health), start.demo);
            let now = move || clock_rate.instant(clock.now()).utc_s();
            let (tell, ticks) = watch::channel(Arc::new(ticker.tick(now())));
            let guard = Guard::new(
                &start.settings,
                start.tokens,
                &start.place,
                Arc::clone(&health),
            );
            let app = App::new((registry, health), guard, ticks, receivers, start.place);
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

    /// Stops the thread.
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

/// Monitors the robots of a configuration until it is stopped.
///
/// # Errors
/// Returns the reason as text if the monitor cannot be started.
pub fn run(file: &Path) -> Result<(), String> {
    let mut config = Config::read(file).map_err(|e| e.to_string())?;
    let place = Place::Folder(config.store.clone());
    let (mut runtime, steps) =
        Runtime::new(Start::at(place.clone())).map_err(|e: StartError| e.to_string())?;
    let mut tokens = Vec::new();
    if config.web.needs_token() {
        for (token, path) in token::all(&config.web, &config.store)? {
            let line = words::log::token_file(&token.name, path.display());
            runtime.health().log(&line);
            tokens.push(token);
        }
    }
    runtime.configure(&config);
    let (receivers, wanted) = watch::channel(config.receivers.clone());
    let (sender, signals) = channel();
    let web = WebStart {
        settings: config.web.clone(),
        tokens,
        demo: None,
        place: place.clone(),
        receivers: wanted,
        mqtt: config.mqtt.clone(),
        steps,
    };
    let web = Web::start(web, &runtime, sender)?;
    if let Some(address) = web.address {
        runtime.health().log(&format!("http://{address}"));
    }
    notify("READY=1");
    let mut exports = crate::months::Months::new(&place, config.thin_after_d);
    run_until_stopped(&signals, &mut runtime, |runtime, signal| {
        if signal == Some(Signal::Reload) {
            reload(file, &mut config, runtime, &receivers);
        }
        exports.look(runtime);
    });
    notify("STOPPING=1");
    runtime.end();
    web.end();
    Ok(())
}

/// Loops until it is stopped; calls `each` in every loop with the received signal.
pub fn run_until_stopped(
    signals: &Receiver<Signal>,
    runtime: &mut Runtime,
    mut each: impl FnMut(&mut Runtime, Option<Signal>),
) {
    let watchdog = watchdog();
    let round = watchdog.map_or(LOOP_TIME, |every| every.min(LOOP_TIME));
    let mut fed = Instant::now();
    loop {
        match signals.recv_timeout(round) {
            Ok(Signal::End) | Err(RecvTimeoutError::Disconnected) => return,
            Ok(signal) => each(runtime, Some(signal)),
            Err(RecvTimeoutError::Timeout) => each(runtime, None),
        }
        runtime.look();
        let alive = runtime.health().silent_for() < MAX_LOOP_AGE;
        if let Some(every) = watchdog
            && alive
            && fed.elapsed() >= every
        {
            notify("WATCHDOG=1");
            fed = Instant::now();
        }
    }
}

/// Reloads the configuration; an invalid one changes nothing.
fn reload(
    file: &Path,
    config: &mut Config,
    runtime: &mut Runtime,
    receivers: &watch::Sender<Vec<NotificationReceiver>>,
) {
    notify("RELOADING=1");
    match Config::read(file) {
        Err(error) => runtime.health().log(&words::log::not_reloaded(error)),
        Ok(next) => {
            let kept: Vec<&str> = [
                (next.web != config.web, "[web]"),
                (
                    (&next.store, next.thin_after_d) != (&config.store, config.thin_after_d),
                    "[store]",
                ),
                (next.mqtt != config.mqtt, "[mqtt]"),
            ]
            .iter()
            .filter_map(|(differs, name)| differs.then_some(*name))
            .collect();
            if !kept.is_empty() {
                let names = kept.join(" and ");
                runtime.health().log(&words::log::needs_restart(&names));
            }
            runtime.configure(&next);
            // Otherwise, waiting notifications keep their order.
            receivers.send_if_modified(|present| {
                let differs = *present != next.receivers;
                present.clone_from(&next.receivers);
                differs
            });
            *config = Config {
                web: config.web.clone(),
                store: config.store.clone(),
                thin_after_d: config.thin_after_d,
                mqtt: config.mqtt.clone(),
                ..next
            };
            runtime.health().log(&words::log::reloaded());
        }
    }
    notify("READY=1");
}
