//! Zenoh session while the transport is connected.

use super::ZenohOptions;
use super::keys::{self, Token};
use super::reader::{TopicReceiver, ZenohReader};
use super::writers::Writers;
use crate::error::PublisherLoss;
use crate::found::PublisherFound;
use crate::handle::Shared;
use crate::network::{End, Listening, MAX_PUBLISHERS, POLL_INTERVAL, Topics, is_description};
use crate::route::Targets;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;
use zenoh::Wait as _;
use zenoh::pubsub::Subscriber;
use zenoh::query::{ConsolidationMode, QueryTarget, ReplyKeyExpr};
use zenoh::sample::SampleKind;

/// Maximum time to wait for the response of a router, ms.
const MAX_ANSWER_TIME_MS: u32 = 3_000;
/// Ratio of the longest reassembled message to the longest accepted message.
const MAX_FRAGMENT_RATIO: usize = 16;
/// Maximum time to wait for an earlier robot description.
const MAX_REPLY_TIME: Duration = Duration::from_secs(10);

/// Maximum time to wait for tokens.
const MAX_TOKEN_TIME: Duration = Duration::from_secs(5);

/// Token that appeared or disappeared.
struct TokenEvent {
    key: String,
    is_present: bool,
}

pub(crate) struct Session<'a> {
    domain: u16,
    endpoints: Vec<String>,
    max_message_bytes: usize,
    listening: &'a Listening,
    shared: &'a Shared,
    session: zenoh::Session,
    /// Subscriber of the tokens; its callback is active while it exists.
    _tokens: Subscriber<()>,
    token_events: Receiver<TokenEvent>,
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
        let (events, token_events) = sync_channel(MAX_PUBLISHERS);
        let thread = std::thread::current();
        let tokens = session
            .liveliness()
            .declare_subscriber(keys::tokens(options.domain))
            .history(true)
            .callback(move |sample| {
                // Tokens beyond the capacity do not belong to a robot.
                let _too_many = events.try_send(TokenEvent {
                    key: sample.key_expr().to_string(),
                    is_present: sample.kind() == SampleKind::Put,
                });
                thread.unpark();
            });
        Ok(Session {
            domain: options.domain,
            endpoints: options.endpoints(),
            max_message_bytes: options.max_message_bytes,
            listening,
            shared,
            _tokens: tokens.wait().map_err(|e| e.to_string())?,
            token_events,
            topics: Topics::new(&listening.routes),
            writers: Writers::new(options.domain, listening.clock),
            session,
        })
    }

    /// Receives until the transport is closed or no router and no peer is connected.
    pub(super) fn listen(mut self) -> End {
        loop {
            if self.shared.stops() {
                return End::Stopped;
            }
            if !is_connected(&self.session) {
                return End::Broken(not_connected(&self.endpoints));
            }
            let (domain, most) = (self.domain, self.max_message_bytes);
            self.topics.follow_routes(
                self.listening,
                &mut opener(&self.session, domain, self.listening, most),
            );
            while let Ok(event) = self.token_events.try_recv() {
                self.handle_token(&event);
            }
            while let Ok(sealed) = self.listening.outgoing.try_recv() {
                let written = self.writers.write(&self.session, sealed);
                self.shared.set_not_published(written.err());
            }
            let now = self.listening.clock.now();
            for subscription in self.topics.subscriptions() {
                let messages = subscription.reader.receiver.count_received();
                self.shared.count(messages as u64);
                subscription.count_received(messages, now);
            }
            std::thread::park_timeout(POLL_INTERVAL);
        }
    }

    fn handle_token(&mut self, event: &TokenEvent) {
        let Some(token) = Token::read(&event.key) else {
            return;
        };
        if token.session == self.session.zid().to_string() {
            return;
        }
        let named = token.named();
        if !event.is_present {
            return self
                .topics
                .lost(self.listening, &token.id, named, PublisherLoss::SignedOff);
        }
        let publisher = PublisherFound {
            id: token.id,
            name: Some(token.node),
            reliability: token.reliability,
            durability: token.durability,
        };
        let what = (token.topic.clone(), token.schema.clone());
        let (domain, most) = (self.domain, self.max_message_bytes);
        self.topics.found(
            self.listening,
            what,
            publisher,
            named,
            &mut opener(&self.session, domain, self.listening, most),
        );
        if is_description(&token.schema) {
            self.query_earlier(&token.topic, &token.schema);
        }
    }

    /// Queries an earlier message. A publisher that does not keep it sends no reply.
    fn query_earlier(&mut self, topic: &str, schema: &str) {
        let Some(subscription) = self.topics.subscriptions().find(|r| r.topic == topic) else {
            return;
        };
        for kept in keys::kept(self.domain, topic, schema) {
            let receiver = Arc::clone(&subscription.reader.receiver);
            let query = self
                .session
                .get(kept)
                .target(QueryTarget::All)
                .consolidation(ConsolidationMode::None)
                .accept_replies(ReplyKeyExpr::Any)
                .timeout(MAX_REPLY_TIME)
                .callback(move |reply| {
                    if let Ok(sample) = reply.result() {
                        receiver.take(sample);
                    }
                });
            // It is queried again when its publisher returns.
            let _result = query.wait();
        }
    }
}

/// Returns the function that subscribes to a topic on behalf of [`Topics`].
fn opener(
    session: &zenoh::Session,
    domain: u16,
    listening: &Listening,
    max_message_bytes: usize,
) -> impl FnMut(&str, &str, &Arc<Targets>) -> Result<ZenohReader, String> {
    move |topic, schema, targets| {
        let receiver = TopicReceiver::new(listening.clock, topic, max_message_bytes, targets);
        let subscribed = Arc::clone(&receiver);
        let subscriber = session
            .declare_subscriber(keys::messages(domain, topic, schema))
            .callback(move |sample| subscribed.take(&sample))
            .wait()
            .map_err(|e| e.to_string())?;
        Ok(ZenohReader {
            receiver,
            _subscriber: subscriber,
        })
    }
}

/// Connects to the first router or peer that responds; nothing is received or published yet.
pub(super) fn join(options: &ZenohOptions) -> Result<zenoh::Session, String> {
    let endpoints = options.endpoints();
    let mut config = zenoh::Config::default();
    let quoted: Vec<String> = endpoints.iter().map(|e| format!("{e:?}")).collect();
    let most = MAX_FRAGMENT_RATIO * options.max_message_bytes;
    for (key, value) in [
        ("mode", "\"client\"".to_owned()),
        ("connect/endpoints", format!("[{}]", quoted.join(","))),
        ("scouting/multicast/enabled", "false".to_owned()),
        (
            "transport/unicast/open_timeout",
            MAX_ANSWER_TIME_MS.to_string(),
        ),
        ("transport/link/rx/max_message_size", most.to_string()),
    ] {
        let set = config.insert_json5(key, &value);
        set.map_err(|e| format!("{key} = {value}: {e}"))?;
    }
    let session = zenoh::open(config).wait();
    session.map_err(|error| format!("{} ({error})", not_connected(&endpoints)))
}

/// Returns the domains with at least one token.
pub(super) fn active_domains(options: &ZenohOptions) -> Result<Vec<u16>, String> {
    let session = join(options)?;
    let query = session
        .liveliness()
        .get(keys::TOKENS)
        .timeout(MAX_TOKEN_TIME);
    let replies = query.wait().map_err(|e| e.to_string())?;
    let mut domains = BTreeSet::new();
    while let Ok(reply) = replies.recv() {
        if let Ok(sample) = reply.result() {
            domains.extend(keys::domain(sample.key_expr()));
        }
    }
    Ok(domains.into_iter().collect())
}

fn not_connected(endpoints: &[String]) -> String {
    format!("no router or peer is connected at {}", endpoints.join(", "))
}

fn is_connected(session: &zenoh::Session) -> bool {
    let info = session.info();
    let router = info.routers_zid().wait().next();
    router.or_else(|| info.peers_zid().wait().next()).is_some()
}
