//! State of the tendons over MQTT 3.1.1, described for the discovery of Home Assistant. Nothing is received: commands come
//! from the page and the API.

use crate::config::MqttSettings;
use crate::hex::hex;
use crate::runtime::{Health, RobotRegistry, RobotState};
use crate::store::word;
use crate::stream::{Stream, connect, secure};
use crate::token::secret;
use crate::web::api::NextTendon;
use crate::words;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::snapshot::{Freshness, TendonSnapshot};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _, WriteHalf};

/// Interval of the states.
const INTERVAL: Duration = Duration::from_secs(10);
/// Time without a packet after which each side closes the connection; the client sends more often.
const KEEP_ALIVE_S: u16 = 60;
/// Time after which Home Assistant shows a state that is not repeated as unavailable: six intervals, s.
const EXPIRE_AFTER_S: u16 = 60;
/// Number of random bytes in the identifier of the client, which has at most 23 characters (MQTT 3.1.1, section 3.1.3.1).
const CLIENT_BYTES: usize = 8;
/// Maximum time to connect.
const MAX_CONNECT_TIME: Duration = Duration::from_secs(30);
/// First bytes of packets: type and flags.
const CONNECT: u8 = 0x10;
const ACCEPTED: u8 = 0x20;
const PUBLISH: u8 = 0x30;
const RETAINED: u8 = 0x31;
const PING: u8 = 0xc0;

/// Publishes the states of all robots until the program ends; a lost connection is opened again.
pub async fn run(settings: MqttSettings, registry: Arc<RobotRegistry>, health: Arc<Health>) {
    let mut logged = None;
    loop {
        let done = publish(&settings, &registry, &health, &mut logged).await;
        if let Err(reason) = done
            && logged.as_ref() != Some(&reason)
        {
            health.log(&words::log::mqtt_disconnected(&settings.host, &reason));
            logged = Some(reason);
        }
        tokio::time::sleep(INTERVAL).await;
    }
}

/// Connects, and publishes until the connection is lost; `logged` is the reason of the last disconnection in the log, `None`
/// after a connection.
async fn publish(
    settings: &MqttSettings,
    registry: &RobotRegistry,
    health: &Health,
    logged: &mut Option<String>,
) -> Result<(), String> {
    let stream = tokio::time::timeout(MAX_CONNECT_TIME, open(settings));
    let late = |_| format!("no answer within {MAX_CONNECT_TIME:?}");
    let (mut received, sender) = tokio::io::split(stream.await.map_err(late)??);
    let mut client = Client {
        settings,
        sender,
        announced: BTreeSet::new(),
    };
    let online = format!("{}/status", settings.prefix);
    client.send(RETAINED, &online, b"online").await?;
    health.log(&words::log::connected(&format!("mqtt {}", settings.host)));
    *logged = None;
    let mut every = tokio::time::interval(INTERVAL);
    every.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    let (mut buffer, mut heard) = ([0; 256], Instant::now());
    loop {
        tokio::select! {
            _ = every.tick() => {
                if heard.elapsed() > Duration::from_secs(KEEP_ALIVE_S.into()) {
                    return Err(format!("no answer within {KEEP_ALIVE_S} s"));
                }
                for (name, slot) in registry.all() {
                    match slot.state() {
                        RobotState::Monitored(robot) => client.robot(&robot).await?,
                        RobotState::Starting | RobotState::NotMonitored(_) => {
                            client.status(&name, false).await?;
                        }
                    }
                }
                client.write(&packet(PING, &[])).await?;
            }
            read = received.read(&mut buffer) => match read {
                Ok(1..) => heard = Instant::now(),
                Ok(0) => return Err("connection closed by the broker".into()),
                Err(error) => return Err(error.to_string()),
            },
        }
    }
}

/// Opens a connection that the broker has accepted.
async fn open(settings: &MqttSettings) -> Result<Box<dyn Stream>, String> {
    let mut stream = connect(&settings.host, settings.port).await?;
    if settings.tls {
        stream = secure(stream, &settings.host, settings.ca_file.as_deref()).await?;
    }
    // Clean session, and a retained last will.
    let mut flags = 0b0010_0110;
    let mut body = Vec::new();
    text(&mut body, "MQTT");
    let mut fields = Vec::new();
    // A broker disconnects the other client with the same identifier; process numbers are the same in containers.
    let mut client = [0; CLIENT_BYTES];
    getrandom::fill(&mut client).map_err(|e| e.to_string())?;
    text(&mut fields, &format!("sinew{}", hex(&client)));
    text(&mut fields, &format!("{}/status", settings.prefix));
    text(&mut fields, "offline");
    if let Some((user, file)) = settings.user.as_ref().zip(settings.password_file.as_ref()) {
        flags |= 0b1100_0000;
        text(&mut fields, user);
        text(&mut fields, &secret(file)?);
    }
    let [high, low] = KEEP_ALIVE_S.to_be_bytes();
    body.extend([4, flags, high, low]);
    body.extend(fields);
    let error = |e: std::io::Error| e.to_string();
    stream
        .write_all(&packet(CONNECT, &body))
        .await
        .map_err(error)?;
    stream.flush().await.map_err(error)?;
    let mut answer = [0; 4];
    stream.read_exact(&mut answer).await.map_err(error)?;
    match answer {
        [ACCEPTED, 2, _, 0] => Ok(stream),
        [ACCEPTED, 2, _, 4 | 5] => Err("user or password rejected".into()),
        [ACCEPTED, 2, _, code] => Err(format!("rejected with code {code}")),
        _ => Err("the answer is not of MQTT 3.1.1".into()),
    }
}

/// Returns a packet with its length.
fn packet(first: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![first];
    let mut length = body.len();
    loop {
        let more = if length > 127 { 128 } else { 0 };
        bytes.push((length % 128) as u8 | more);
        length /= 128;
        if length == 0 {
            break;
        }
    }
    bytes.extend(body);
    bytes
}

/// Adds a text with its length.
fn text(body: &mut Vec<u8>, text: &str) {
    body.extend((text.len() as u16).to_be_bytes());
    body.extend(text.as_bytes());
}

/// Returns a name as one level of a topic, and as part of an identifier. Characters other than letters, digits, - and _
/// are replaced; the beginning of a hash keeps names apart that differ in such characters only.
fn level(name: &str) -> String {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    if name.chars().all(fits) {
        return name.to_owned();
    }
    let hash = hex(&Sha256::digest(name));
    let replaced = name.chars().map(|c| if fits(c) { c } else { '_' });
    replaced.chain(['_']).chain(hash.chars().take(8)).collect()
}

/// Connection that has been accepted.
struct Client<'s> {
    settings: &'s MqttSettings,
    sender: WriteHalf<Box<dyn Stream>>,
    /// Topics of tendons whose entities are described to this broker.
    announced: BTreeSet<String>,
}

impl Client<'_> {
    async fn write(&mut self, packet: &[u8]) -> Result<(), String> {
        let sent = async {
            self.sender.write_all(packet).await?;
            self.sender.flush().await
        };
        // A broker that reads nothing blocks the connection.
        let sent = tokio::time::timeout(Duration::from_secs(KEEP_ALIVE_S.into()), sent).await;
        match sent {
            Ok(sent) => sent.map_err(|e: std::io::Error| e.to_string()),
            Err(_late) => Err(format!(
                "the broker accepted no data within {KEEP_ALIVE_S} s"
            )),
        }
    }

    async fn send(&mut self, first: u8, topic: &str, payload: &[u8]) -> Result<(), String> {
        let mut body = Vec::new();
        text(&mut body, topic);
        body.extend(payload);
        self.write(&packet(first, &body)).await
    }

    /// Publishes whether current data of a robot are available; returns the topic.
    async fn status(&mut self, robot: &str, is_online: bool) -> Result<String, String> {
        let topic = format!("{}/{}/status", self.settings.prefix, level(robot));
        let status: &[u8] = if is_online { b"online" } else { b"offline" };
        self.send(RETAINED, &topic, status).await?;
        Ok(topic)
    }

    /// Publishes the tendons of a robot, and describes those that are new.
    async fn robot(&mut self, robot: &RobotSnapshot) -> Result<(), String> {
        let is_online = matches!(robot.freshness, Freshness::Fresh);
        let status = self.status(&robot.robot, is_online).await?;
        let of_robot = format!("{}/{}", self.settings.prefix, level(&robot.robot));
        for tendon in &robot.tendons {
            let topic = format!("{of_robot}/tendon/{}", level(&tendon.joint));
            if self.announced.insert(topic.clone()) {
                for (id, entity) in entities(self.settings, robot, tendon, &topic, &status) {
                    let config = format!("{}/sensor/{id}/config", self.settings.discovery);
                    self.send(RETAINED, &config, entity.to_string().as_bytes())
                        .await?;
                }
            }
            let state = state(robot, tendon).to_string();
            self.send(PUBLISH, &topic, state.as_bytes()).await?;
        }
        Ok(())
    }
}

/// Returns the state of a tendon; a missing value is `null`.
fn state(robot: &RobotSnapshot, tendon: &TendonSnapshot) -> Value {
    json!({
        "offset_mrad": tendon.offset_rad.map(|x| 1e3 * x.mean),
        "offset_interval_95_mrad": tendon.offset_rad.map(|x| 1e3 * x.half_width_95()),
        "limit_used_percent": NextTendon::of(tendon).map(|next| 100.0 * next.share),
        "alarm": word(&tendon.level),
        "text": words::tendon(tendon, &robot.alarms),
    })
}

/// Returns the discovery topic, without its beginning and end, and the description of the entities of a tendon.
fn entities(
    settings: &MqttSettings,
    robot: &RobotSnapshot,
    tendon: &TendonSnapshot,
    topic: &str,
    status: &str,
) -> [(String, Value); 3] {
    let of_monitor = json!({ "topic": format!("{}/status", settings.prefix) });
    // Monitors with the same robots and one broker differ in the prefix.
    let device = format!("{}_{}", level(&settings.prefix), level(&robot.robot));
    let number = |unit: &str| json!({ "unit_of_measurement": unit, "state_class": "measurement" });
    [
        ("offset_mrad", "offset", number("mrad")),
        ("limit_used_percent", "share of limit", number("%")),
        (
            "alarm",
            "alarm",
            json!({
                "device_class": "enum", "options": ["OK", "WARN", "ERROR", "STALE"],
                "json_attributes_topic": topic,
            }),
        ),
    ]
    .map(|(key, name, mut entity)| {
        let id = format!("{device}/{}_{key}", level(&tendon.joint));
        // The alarm of a robot without data remains valid.
        let available = match key {
            "alarm" => json!([of_monitor]),
            _ => json!([of_monitor, { "topic": status }]),
        };
        entity["name"] = json!(format!("{} {name}", tendon.joint));
        entity["unique_id"] = json!(id);
        entity["expire_after"] = json!(EXPIRE_AFTER_S);
        entity["state_topic"] = json!(topic);
        entity["value_template"] = json!(format!("{{{{ value_json.{key} }}}}"));
        entity["availability"] = available;
        entity["availability_mode"] = json!("all");
        entity["device"] = json!({
            "identifiers": [device], "name": robot.robot, "manufacturer": "Sinew", "model": robot.robot_type,
        });
        (id, entity)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_keeps_names_apart_without_wildcards() {
        assert_eq!(level("arm-7_a"), "arm-7_a");
        let levels: BTreeSet<String> = ["arm_7", "arm.7", "arm/7", "arm+7", "arm#7"]
            .into_iter()
            .map(level)
            .collect();
        assert_eq!(levels.len(), 5, "{levels:?}");
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        assert!(levels.iter().all(|level| level.chars().all(is_plain)));
    }
}
