//! Settings of the web page and of the webhooks.

use sinew_files::{Fields as _, Located, Section};
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};

/// Default address of the page.
const BIND: &str = "127.0.0.1:8642";

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
    Ok(WebSettings {
        bind: bind.filter(|_| !off),
        host_names,
        token_file: super::path(s, "token_file", folder)?,
        token_on_loopback: s.flag("token_on_loopback")?,
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
pub struct Webhook {
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
}

impl Webhook {
    /// Returns the address as `http://HOST:PORT/PATH`.
    pub fn url(&self) -> String {
        format!("http://{}:{}{}", self.host, self.port, self.path)
    }
}

pub(super) fn read_webhook(s: &Section<'_>, folder: &Path) -> Result<Webhook, Located> {
    let must = "http://HOST[:PORT]/PATH; for https, run a proxy on this host";
    let url = s.need_text("url", "set the address that alarms are posted to")?;
    let parsed = match url.is_empty() {
        true => (String::new(), 80, String::from("/")),
        false => split(&url).ok_or_else(|| s.invalid("url", must))?,
    };
    let severity_min = s.count("severity_min")?.unwrap_or(1);
    if severity_min > 1000 {
        return Err(s.invalid("severity_min", "between 0 and 1000"));
    }
    let formats = [
        ("sinew", PostFormat::Sinew),
        ("ntfy", PostFormat::Ntfy),
        ("slack", PostFormat::Slack),
    ];
    let format = s.one_of("format", &formats)?.unwrap_or_default();
    let (host, port, path) = parsed;
    Ok(Webhook {
        host,
        port,
        path,
        format,
        severity_min: severity_min as u16,
        token_file: super::path(s, "token_file", folder)?,
    })
}

/// Splits an address into host, port and path.
fn split(url: &str) -> Option<(String, u16, String)> {
    let rest = url.strip_prefix("http://")?;
    let (authority, path) = match rest.find(['/', '?']) {
        Some(at) => rest.split_at(at),
        None => (rest, ""),
    };
    let path = match path.starts_with('/') {
        true => path.to_owned(),
        false => format!("/{path}"),
    };
    let (host, port) = match authority.rsplit_once(':') {
        Some((host, port)) if !port.contains(']') => (host, port.parse().ok()?),
        _ => (authority, 80),
    };
    let bare = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
    let fits = match bare {
        Some(bare) => matches!(bare.parse(), Ok(IpAddr::V6(_))),
        None => is_host_name(host) && !host.contains([':', '[', ']']),
    };
    let clean = path.bytes().all(|b| b.is_ascii_graphic() && b != b'#');
    (fits && clean).then(|| (host.to_owned(), port, path))
}
