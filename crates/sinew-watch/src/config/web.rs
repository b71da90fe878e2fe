//! Settings of the web page, and of the receivers of notifications.

use sinew_files::{Fault, Fields as _, Located, Section};
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};

/// Default address of the page.
const BIND: &str = "127.0.0.1:8642";
/// Maximum length of the beginning of a topic, characters.
const MAX_TOPIC_CHARS: usize = 64;
/// Maximum length of the name of a token, characters.
const MAX_TOKEN_NAME: usize = 64;

/// Settings of the web page and its access control.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WebSettings {
    /// Address of the page; `None`: no page.
    pub bind: Option<SocketAddr>,
    /// Additional host names that browsers may use for this host, besides its address and `localhost`.
    pub host_names: Vec<String>,
    /// File of the token required from other hosts; `None`: `web-token` in the store directory.
    pub token_file: Option<PathBuf>,
    /// Whether the token is required from this host as well.
    pub token_on_loopback: bool,
    /// Tokens besides that of `token_file`.
    pub tokens: Vec<TokenSettings>,
    /// Address of the page for links in notifications, without a slash at its end; `None`: no links.
    pub url: Option<String>,
}

/// Permission of the holders of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Reads pages and API.
    Read,
    /// Also executes operator commands and sends test notifications.
    Operate,
}

impl Role {
    /// Returns the name used in the configuration and in cookies.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Operate => "operate",
        }
    }
}

/// Additional access token.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TokenSettings {
    /// Name of the token.
    pub name: String,
    /// Permission of its holders.
    pub role: Role,
    /// File of the token; `None`: `web-token-NAME` in the store directory.
    pub file: Option<PathBuf>,
}

impl WebSettings {
    /// Whether requests need the token.
    pub fn needs_token(&self) -> bool {
        self.bind
            .is_some_and(|bind| self.token_on_loopback || !bind.ip().is_loopback())
    }
}

impl Default for WebSettings {
    fn default() -> Self {
        Self {
            bind: BIND.parse().ok(),
            host_names: Vec::new(),
            token_file: None,
            token_on_loopback: false,
            tokens: Vec::new(),
            url: None,
        }
    }
}

pub(super) fn read(s: &Section<'_>, folder: &Path) -> Result<WebSettings, Located> {
    let plain = WebSettings::default();
    let off = s.flag("off")?;
    let bind = match s.value("bind") {
        None => plain.bind,
        Some(value) => {
            let must = "an address and a port, such as \"127.0.0.1:8642\" or \"[::1]:8642\"";
            Some(value.text()?.parse().map_err(|_| value.invalid(must))?)
        }
    };
    let mut host_names = Vec::new();
    if let Some(value) = s.value("host_names") {
        for name in value.list("a list of names of this host")? {
            let text = name.text()?;
            if !is_host_name(text) {
                return Err(name
                    .invalid("a name of this host without port, such as \"cell-3.example.org\""));
            }
            host_names.push(text.to_ascii_lowercase());
        }
    }
    let tokens = s.each("token", |s| token(s, folder))?;
    for (i, token) in tokens.iter().enumerate() {
        if tokens.iter().take(i).any(|other| other.name == token.name) {
            let twice = format!("duplicate token name '{}'", token.name);
            let located = s.here(Fault::Contradiction, twice).key("web.token.name");
            return Err(located.cure("give every token a unique name"));
        }
    }
    let token_on_loopback = s.flag("token_on_loopback")?;
    let is_open = bind.is_some_and(|bind| bind.ip().is_loopback()) && !token_on_loopback;
    if is_open && !off && !tokens.is_empty() {
        let unused = "no token is required at a loopback address";
        let located = s.here(Fault::Contradiction, unused).key("web.token");
        return Err(located.cure("set token_on_loopback = true, or remove the tokens"));
    }
    let url = s.text("url")?;
    if url.as_deref().is_some_and(|url| split(url).is_none()) {
        return Err(s.invalid("url", "http://HOST[:PORT] or https://HOST[:PORT]"));
    }
    Ok(WebSettings {
        tokens,
        url: url.map(|url| url.trim_end_matches('/').to_owned()),
        bind: bind.filter(|_| !off),
        host_names,
        token_file: super::path(s, "token_file", folder)?,
        token_on_loopback,
    })
}

fn token(s: &Section<'_>, folder: &Path) -> Result<TokenSettings, Located> {
    let name = s.need_text(
        "name",
        "name the person, group or program that has the token",
    )?;
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if !name.is_empty() && (name.len() > MAX_TOKEN_NAME || !name.chars().all(fits)) {
        return Err(s.invalid("name", "up to 64 letters, digits, -, _ or ."));
    }
    let roles = [("read", Role::Read), ("operate", Role::Operate)];
    let role = s.one_of("role", &roles)?;
    let role = s.needed(role, "role", "set \"read\" or \"operate\"", Role::Read);
    Ok(TokenSettings {
        name,
        role,
        file: super::path(s, "file", folder)?,
    })
}

fn is_host_name(text: &str) -> bool {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-._:[]".contains(c);
    !text.is_empty() && text.len() <= 253 && text.chars().all(fits)
}

/// Format of the notifications that a receiver accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PostFormat {
    /// JSON object `sinew-webhook/2`.
    #[default]
    Sinew,
    /// Text with title and priority for a topic of ntfy.
    Ntfy,
    /// JSON object with a text, as the incoming webhooks of Slack and Mattermost accept.
    Slack,
}

/// Receiver of alarm notifications.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Receiver {
    /// Address that notifications are posted to.
    Webhook(Webhook),
    /// Mailboxes that notifications are sent to.
    Mail(Mail),
}

impl Receiver {
    /// Returns the name of the receiver in results and in the log: its address, without the parts that may be secret.
    pub fn name(&self) -> String {
        match self {
            Self::Webhook(hook) => hook.name(),
            Self::Mail(mail) => format!(
                "mail to {} by {}:{}",
                mail.to.join(", "),
                mail.host,
                mail.port
            ),
        }
    }

    /// Returns the minimum severity of the alarms that are sent.
    pub fn severity_min(&self) -> u16 {
        match self {
            Self::Webhook(hook) => hook.severity_min,
            Self::Mail(mail) => mail.severity_min,
        }
    }
}

/// Address that notifications are posted to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Webhook {
    /// Whether the connection uses TLS.
    pub tls: bool,
    /// Host, as in the request.
    pub host: String,
    /// TCP port of the host.
    pub port: u16,
    /// Path and query.
    pub path: String,
    /// Format of the notifications.
    pub format: PostFormat,
    /// Minimum severity of the posted alarms.
    pub severity_min: u16,
    /// File of the bearer token sent with each request.
    pub token_file: Option<PathBuf>,
    /// Certificates of the trusted authorities (PEM); `None`: those of the operating system.
    pub ca_file: Option<PathBuf>,
}

impl Webhook {
    /// Returns the address as `http://HOST:PORT/PATH`.
    pub fn url(&self) -> String {
        self.at(&self.path)
    }

    /// Returns the address without its query, and for ntfy and Slack without the path: it permits to post.
    fn name(&self) -> String {
        match self.format {
            PostFormat::Sinew => self.at(self.path.split('?').next().unwrap_or_default()),
            PostFormat::Ntfy | PostFormat::Slack => self.at(""),
        }
    }

    fn at(&self, path: &str) -> String {
        let scheme = if self.tls { "https" } else { "http" };
        format!("{scheme}://{}:{}{path}", self.host, self.port)
    }
}

/// Mailboxes and the server that accepts mail for them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mail {
    /// Host of the server.
    pub host: String,
    /// TCP port of the server.
    pub port: u16,
    /// Encryption of the connection.
    pub tls: MailTls,
    /// Certificates of the trusted authorities (PEM); `None`: those of the operating system.
    pub ca_file: Option<PathBuf>,
    /// Address of the sender.
    pub from: String,
    /// Addresses of the receivers, at least one.
    pub to: Vec<String>,
    /// Name of the user at the server; `None`: no login.
    pub user: Option<String>,
    /// File of the password; present with a user.
    pub password_file: Option<PathBuf>,
    /// Minimum severity of the sent alarms.
    pub severity_min: u16,
    /// Address of the page for links.
    pub page: Option<String>,
}

impl Mail {
    /// Returns the domain of the sender.
    pub fn domain(&self) -> &str {
        self.from
            .rsplit_once('@')
            .map_or("localhost", |(_, domain)| domain)
    }
}

/// Encryption of the connection to a mail server.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MailTls {
    /// TLS that begins after the command STARTTLS, usually on port 587.
    #[default]
    StartTls,
    /// TLS from the beginning, usually on port 465.
    Implicit,
    /// No encryption, usually on port 25.
    Off,
}

impl MailTls {
    /// Returns the usual port.
    fn port(self) -> u16 {
        match self {
            Self::StartTls => 587,
            Self::Implicit => 465,
            Self::Off => 25,
        }
    }
}

/// Broker to which the states of the tendons are published.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MqttSettings {
    /// Host of the broker.
    pub host: String,
    /// TCP port of the broker.
    pub port: u16,
    /// Whether the connection uses TLS.
    pub tls: bool,
    /// Certificates of the trusted authorities (PEM); `None`: those of the operating system.
    pub ca_file: Option<PathBuf>,
    /// Name of the user at the broker; `None`: no login.
    pub user: Option<String>,
    /// File of the password; present with a user.
    pub password_file: Option<PathBuf>,
    /// Beginning of the topics.
    pub prefix: String,
    /// Beginning of the discovery topics of Home Assistant.
    pub discovery: String,
}

pub(super) fn read_mqtt(s: &Section<'_>, folder: &Path) -> Result<MqttSettings, Located> {
    let broker = s.need_text("broker", "set the broker as HOST or HOST:PORT")?;
    let tls = s.flag("tls")?;
    let usual = if tls { 8883 } else { 1883 };
    let (host, port) = match broker.is_empty() {
        true => (String::new(), usual),
        false => {
            host_and_port(&broker, usual).ok_or_else(|| s.invalid("broker", "HOST or HOST:PORT"))?
        }
    };
    let topic = |key: &'static str, usual: &str| {
        let text = s.text(key)?.unwrap_or_else(|| usual.to_owned());
        let fits = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
        match !text.is_empty() && text.len() <= MAX_TOPIC_CHARS && text.chars().all(fits) {
            true => Ok(text),
            false => Err(s.invalid(key, "up to 64 letters, digits, -, _, . or /")),
        }
    };
    let (user, password_file) = login(s, folder)?;
    Ok(MqttSettings {
        host,
        port,
        tls,
        ca_file: ca_file(s, folder, tls, "used with tls = true")?,
        user,
        password_file,
        prefix: topic("prefix", "sinew")?,
        discovery: topic("discovery", "homeassistant")?,
    })
}

/// Reads user and file of the password, which belong together.
fn login(s: &Section<'_>, folder: &Path) -> Result<(Option<String>, Option<PathBuf>), Located> {
    let user = s.text("user")?;
    let password_file = super::path(s, "password_file", folder)?;
    match (&user, &password_file) {
        (Some(_), None) => Err(s.missing("password_file", "a login needs user and password_file")),
        (None, Some(_)) => Err(s.missing("user", "a login needs user and password_file")),
        _ => Ok((user, password_file)),
    }
}

/// Reads the file of the trusted authorities, which has no effect without TLS.
fn ca_file(
    s: &Section<'_>,
    folder: &Path,
    tls: bool,
    must: &str,
) -> Result<Option<PathBuf>, Located> {
    match super::path(s, "ca_file", folder)? {
        Some(_) if !tls => Err(s.invalid("ca_file", must)),
        file => Ok(file),
    }
}

/// Reads the minimum severity.
fn severity_min(s: &Section<'_>) -> Result<u16, Located> {
    match s.count("severity_min")?.unwrap_or(1) {
        severity @ 0..=1000 => Ok(severity as u16),
        _ => Err(s.invalid("severity_min", "between 0 and 1000")),
    }
}

pub(super) fn read_webhook(s: &Section<'_>, folder: &Path) -> Result<Webhook, Located> {
    let must = "http://HOST[:PORT]/PATH or https://HOST[:PORT]/PATH";
    let url = s.need_text("url", "set the address that alarms are posted to")?;
    let parsed = match url.is_empty() {
        true => (false, String::new(), 80, String::from("/")),
        false => split(&url).ok_or_else(|| s.invalid("url", must))?,
    };
    let formats = [
        ("sinew", PostFormat::Sinew),
        ("ntfy", PostFormat::Ntfy),
        ("slack", PostFormat::Slack),
    ];
    let (tls, host, port, path) = parsed;
    Ok(Webhook {
        tls,
        host,
        port,
        path,
        format: s.one_of("format", &formats)?.unwrap_or_default(),
        severity_min: severity_min(s)?,
        token_file: super::path(s, "token_file", folder)?,
        ca_file: ca_file(s, folder, tls || url.is_empty(), "used with https://")?,
    })
}

pub(super) fn read_mail(s: &Section<'_>, folder: &Path) -> Result<Mail, Located> {
    let server = s.need_text("server", "set the mail server as HOST or HOST:PORT")?;
    let modes = [
        ("starttls", MailTls::StartTls),
        ("implicit", MailTls::Implicit),
        ("off", MailTls::Off),
    ];
    let tls = s.one_of("tls", &modes)?.unwrap_or_default();
    let (host, port) = match server.is_empty() {
        true => (String::new(), tls.port()),
        false => host_and_port(&server, tls.port())
            .ok_or_else(|| s.invalid("server", "HOST or HOST:PORT"))?,
    };
    let must = "a mail address such as \"ada@example.org\"";
    let from = s.need_text("from", "set the mail address of the sender")?;
    if !from.is_empty() && !is_mail_address(&from) {
        return Err(s.invalid("from", must));
    }
    let mut to = Vec::new();
    if let Some(list) = s.value("to") {
        for address in list.list("a list of mail addresses")? {
            let text = address.text()?;
            if !is_mail_address(text) {
                return Err(address.invalid(must));
            }
            to.push(text.to_owned());
        }
    }
    if to.is_empty() {
        return Err(s.missing("to", "list the mail addresses of the receivers"));
    }
    let (user, password_file) = login(s, folder)?;
    if user.is_some() && tls == MailTls::Off {
        let must = "\"starttls\" or \"implicit\" with a user: a password is not sent unencrypted";
        return Err(s.invalid("tls", must));
    }
    Ok(Mail {
        host,
        port,
        tls,
        ca_file: super::path(s, "ca_file", folder)?,
        from,
        to,
        user,
        password_file,
        severity_min: severity_min(s)?,
        page: None,
    })
}

/// Whether a text is an address that needs no quoting: ASCII without spaces and special characters.
fn is_mail_address(text: &str) -> bool {
    let fits = |c: char| c.is_ascii_alphanumeric() || "!#$%&'*+-/=?^_`{|}~.".contains(c);
    text.split_once('@').is_some_and(|(local, domain)| {
        !local.is_empty() && local.chars().all(fits) && is_host_name(domain)
    })
}

/// Splits an address into TLS, host, port and path.
fn split(url: &str) -> Option<(bool, String, u16, String)> {
    let (tls, rest) = match url.strip_prefix("https://") {
        Some(rest) => (true, rest),
        None => (false, url.strip_prefix("http://")?),
    };
    let (authority, path) = match rest.find(['/', '?']) {
        Some(at) => rest.split_at(at),
        None => (rest, ""),
    };
    let path = match path.starts_with('/') {
        true => path.to_owned(),
        false => format!("/{path}"),
    };
    let (host, port) = host_and_port(authority, if tls { 443 } else { 80 })?;
    let clean = path.bytes().all(|b| b.is_ascii_graphic() && b != b'#');
    clean.then_some((tls, host, port, path))
}

/// Splits `HOST[:PORT]`; IPv6 addresses are in brackets.
fn host_and_port(authority: &str, usual: u16) -> Option<(String, u16)> {
    let (host, port) = match authority.rsplit_once(':') {
        Some((host, port)) if !port.contains(']') => (host, port.parse().ok()?),
        _ => (authority, usual),
    };
    let bare = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
    let fits = match bare {
        Some(bare) => matches!(bare.parse(), Ok(IpAddr::V6(_))),
        None => is_host_name(host) && !host.contains([':', '[', ']']),
    };
    fits.then(|| (host.to_owned(), port))
}
