//! A session of Zenoh while the door stands open.

use super::ZenohOptions;
use super::keys::{self, Token};
use super::reader::{Ear, ZenohReader};
use super::writers::Writers;
use crate::found::PublisherFound;
use crate::handle::Shared;
use crate::network::{End, IDLE, Listening, PUBLISHERS_MOST, Topics, is_description};
use crate::route::Targets;
use crate::trouble::Lost;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;
use zenoh::Wait as _;
use zenoh::pubsub::Subscriber;
use zenoh::query::{ConsolidationMode, QueryTarget, ReplyKeyExpr};
use zenoh::sample::SampleKind;

/// A router that takes longer to answer isn't there, ms.
const ANSWER_MOST_MS: u32 = 3_000;
/// Messages longer than so many times what is taken are never put together.
const FRAGMENTS_MOST: usize = 16;
/// For so long a description that was published before may come.
const KEPT_MOST: Duration = Duration::from_secs(10);

/// Tokens are waited for so long.
const TOKENS_MOST: Duration = Duration::from_secs(5);

/// A token that came or went.
struct Said {
    key: String,
    is_there: bool,
}

pub(crate) struct Session<'a> {
    domain: u16,
    endpoints: Vec<String>,
    message_most_bytes: usize,
    listening: &'a Listening,
    shared: &'a Shared,
    session: zenoh::Session,
    /// Its callback is called as long as it lives.
    _tokens: Subscriber<()>,
    said: Receiver<Said>,
    topics: Topics<ZenohReader>,
    writers: Writers,
}

impl<'a> Session<'a> {
    pub(super) fn join(
        options: &ZenohOptions,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Self, String> {
        let session = join(options)?;
        let (say, said) = sync_channel(PUBLISHERS_MOST);
        let thread = std::thread::current();
        let tokens = session
            .liveliness()
            .declare_subscriber(keys::tokens(options.domain))
            .history(true)
            .callback(move |sample| {
                // More than that at once is nobody's robot.
                let _too_many = say.try_send(Said {
                    key: sample.key_expr().to_string(),
                    is_there: sample.kind() == SampleKind::Put,
                });
                thread.unpark();
            });
        Ok(Session {
            domain: options.domain,
            endpoints: options.endpoints(),
            message_most_bytes: options.message_most_bytes,
            listening,
            shared,
            _tokens: tokens.wait().map_err(|e| e.to_string())?,
            said,
            topics: Topics::new(&listening.routes),
            writers: Writers::new(options.domain, listening.clock),
            session,
        })
    }

    /// Until the door is shut, or nobody is connected any more.
    pub(super) fn listen(mut self) -> End {
        loop {
            if self.shared.stops() {
                return End::Stopped;
            }
            if !is_connected(&self.session) {
                return End::Broken(nobody(&self.endpoints));
            }
            let (domain, most) = (self.domain, self.message_most_bytes);
            self.topics.follow_routes(
                self.listening,
                &mut opener(&self.session, domain, self.listening, most),
            );
            while let Ok(said) = self.said.try_recv() {
                self.hear_of(&said);
            }
            while let Ok(sealed) = self.listening.outgoing.try_recv() {
                let written = self.writers.write(&self.session, sealed);
                self.shared.set_not_published(written.err());
            }
            let now = self.listening.clock.now();
            for reading in self.topics.readings() {
                let messages = reading.reader.ear.heard();
                self.shared.count(messages as u64);
                reading.heard(messages, now);
            }
            std::thread::park_timeout(IDLE);
        }
    }

    fn hear_of(&mut self, said: &Said) {
        let Some(token) = Token::read(&said.key) else {
            return;
        };
        if token.session == self.session.zid().to_string() {
            return;
        }
        let named = token.named();
        if !said.is_there {
            return self
                .topics
                .lost(self.listening, &token.id, named, Lost::Left);
        }
        let publisher = PublisherFound {
            id: token.id,
            name: Some(token.node),
            reliability: token.reliability,
            durability: token.durability,
        };
        let what = (token.topic.clone(), token.schema.clone());
        let (domain, most) = (self.domain, self.message_most_bytes);
        self.topics.found(
            self.listening,
            what,
            publisher,
            named,
            &mut opener(&self.session, domain, self.listening, most),
        );
        if is_description(&token.schema) {
            self.ask(&token.topic, &token.schema);
        }
    }

    /// Asks for what was published before. One who doesn't keep it says nothing.
    fn ask(&mut self, topic: &str, schema: &str) {
        let Some(reading) = self.topics.readings().find(|r| r.topic == topic) else {
            return;
        };
        for kept in keys::kept(self.domain, topic, schema) {
            let ear = Arc::clone(&reading.reader.ear);
            let asked = self
                .session
                .get(kept)
                .target(QueryTarget::All)
                .consolidation(ConsolidationMode::None)
                .accept_replies(ReplyKeyExpr::Any)
                .timeout(KEPT_MOST)
                .callback(move |reply| {
                    if let Ok(sample) = reply.result() {
                        ear.take(sample);
                    }
                });
            // It is asked again when its publisher comes again.
            let _unasked = asked.wait();
        }
    }
}

/// Reads a topic, as [`Topics`] asks for it.
fn opener(
    session: &zenoh::Session,
    domain: u16,
    listening: &Listening,
    message_most_bytes: usize,
) -> impl FnMut(&str, &str, &Arc<Targets>) -> Result<ZenohReader, String> {
    move |topic, schema, targets| {
        let ear = Ear::new(listening.clock, topic, message_most_bytes, targets);
        let hears = Arc::clone(&ear);
        let subscriber = session
            .declare_subscriber(keys::messages(domain, topic, schema))
            .callback(move |sample| hears.take(&sample))
            .wait()
            .map_err(|e| e.to_string())?;
        Ok(ZenohReader {
            ear,
            _subscriber: subscriber,
        })
    }
}

/// Connects to the first router or peer that answers; nothing is read or published yet.
pub(super) fn join(options: &ZenohOptions) -> Result<zenoh::Session, String> {
    let endpoints = options.endpoints();
    let mut config = zenoh::Config::default();
    let quoted: Vec<String> = endpoints.iter().map(|e| format!("{e:?}")).collect();
    let most = FRAGMENTS_MOST * options.message_most_bytes;
    for (key, value) in [
        ("mode", "\"client\"".to_owned()),
        ("connect/endpoints", format!("[{}]", quoted.join(","))),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("transport/unicast/open_timeout", ANSWER_MOST_MS.to_string()),
        ("transport/link/rx/max_message_size", most.to_string()),
    ] {
        let set = config.insert_json5(key, &value);
        set.map_err(|e| format!("{key} = {value}: {e}"))?;
    }
    let opened = zenoh::open(config).wait();
    opened.map_err(|error| format!("{} ({error})", nobody(&endpoints)))
}

/// Domains in which somebody has a token.
pub(super) fn active_domains(options: &ZenohOptions) -> Result<Vec<u16>, String> {
    let session = join(options)?;
    let asked = session.liveliness().get(keys::TOKENS).timeout(TOKENS_MOST);
    let replies = asked.wait().map_err(|e| e.to_string())?;
    let mut domains = BTreeSet::new();
    while let Ok(reply) = replies.recv() {
        if let Ok(sample) = reply.result() {
            domains.extend(keys::domain(sample.key_expr()));
        }
    }
    Ok(domains.into_iter().collect())
}

fn nobody(endpoints: &[String]) -> String {
    format!("no router or peer is connected at {}", endpoints.join(", "))
}

fn is_connected(session: &zenoh::Session) -> bool {
    let info = session.info();
    let router = info.routers_zid().wait().next();
    router.or_else(|| info.peers_zid().wait().next()).is_some()
}
