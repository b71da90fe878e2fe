//! Logins of browsers, and addresses that send wrong tokens.

use crate::hex::hex;
use crate::runtime::{Health, lock};
use crate::words;
use sha2::{Digest as _, Sha256};
use sinew_files::{Temporary, folder_of};
use std::collections::{BTreeMap, HashMap};
use std::io::Write as _;
use std::net::{IpAddr, Ipv6Addr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Duration of a login, s.
pub(super) const LOGIN_S: u64 = 30 * 86_400;
/// Maximum number of logins; the one that ends first is replaced.
const MAX_LOGINS: usize = 1000;
/// Number of random bytes that identify a login.
const LOGIN_BYTES: usize = 32;
/// Number of wrong tokens of an address within [`EXCLUSION`] after which its tokens are not compared any more. A person
/// mistypes a few times; with 10 attempts per minute the shortest token allowed, 16 characters, is not found.
const MAX_WRONG_TOKENS: usize = 10;
/// Time after which a wrong token counts no more.
const EXCLUSION: Duration = Duration::from_secs(60);

/// Logins, kept in the folder of the token so that they survive a restart.
pub(super) struct Logins {
    /// File of the logins; `None`: in memory.
    file: Option<PathBuf>,
    health: Arc<Health>,
    /// End of each login, s since 1970 UTC, by the hash of token and cookie: neither is stored.
    open: Mutex<BTreeMap<String, u64>>,
    /// Times of wrong tokens of each address.
    wrong: Mutex<HashMap<IpAddr, Vec<Instant>>>,
}

impl Logins {
    /// Creates the logins, with those of a previous run.
    pub(super) fn new(file: Option<PathBuf>, health: Arc<Health>) -> Self {
        let open = file.as_deref().map(read).unwrap_or_default();
        Self {
            file,
            health,
            open: Mutex::new(open),
            wrong: Mutex::default(),
        }
    }

    /// Adds a login; returns the content of its cookie, or `None` if the system yields no random numbers.
    pub(super) fn add(&self, token: &str) -> Option<String> {
        let mut bytes = [0; LOGIN_BYTES];
        getrandom::fill(&mut bytes).ok()?;
        let cookie = hex(&bytes);
        let mut open = lock(&self.open);
        let now_s = now_s();
        open.retain(|_, end| *end > now_s);
        while open.len() >= MAX_LOGINS {
            let first = open.iter().min_by_key(|(_, end)| **end);
            let Some(first) = first.map(|(hash, _)| hash.clone()) else {
                break;
            };
            open.remove(&first);
        }
        open.insert(hash(token, &cookie), now_s + LOGIN_S);
        self.write(&open);
        Some(cookie)
    }

    /// Whether a cookie belongs to a login.
    pub(super) fn has(&self, token: &str, cookie: &str) -> bool {
        let open = lock(&self.open);
        open.get(&hash(token, cookie))
            .is_some_and(|end| *end > now_s())
    }

    /// Ends the login of a cookie.
    pub(super) fn remove(&self, token: &str, cookie: &str) {
        let mut open = lock(&self.open);
        if open.remove(&hash(token, cookie)).is_some() {
            self.write(&open);
        }
    }

    fn write(&self, open: &BTreeMap<String, u64>) {
        let Some(file) = &self.file else { return };
        if let Err(reason) = store(file, open) {
            self.health.log(&words::log::logins_not_stored(reason));
        }
    }

    /// Whether tokens of an address are not compared, because it has sent too many wrong ones.
    pub(super) fn is_excluded(&self, address: IpAddr) -> bool {
        let mut wrong = lock(&self.wrong);
        let Some(times) = wrong.get_mut(&network(address)) else {
            return false;
        };
        times.retain(|at| at.elapsed() < EXCLUSION);
        times.len() >= MAX_WRONG_TOKENS
    }

    /// Counts and logs a wrong token of an address.
    pub(super) fn count_wrong(&self, address: IpAddr) {
        let count = {
            let mut wrong = lock(&self.wrong);
            wrong.retain(|_, times| times.iter().any(|at| at.elapsed() < EXCLUSION));
            let times = wrong.entry(network(address)).or_default();
            times.push(Instant::now());
            times.len()
        };
        let line = match count {
            MAX_WRONG_TOKENS => words::log::too_many_tokens(address),
            _ => words::log::wrong_token(address),
        };
        self.health.log_once(&line);
    }
}

/// Returns the part of an address that identifies a client: IPv6 clients have 2⁶⁴ addresses each.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V4(v4) => IpAddr::V4(v4),
        IpAddr::V6(v6) => IpAddr::V6(Ipv6Addr::from_bits(v6.to_bits() & (u128::MAX << 64))),
    }
}

fn hash(token: &str, cookie: &str) -> String {
    hex(&Sha256::digest(format!(
        "sinew-watch login\n{token}\n{cookie}"
    )))
}

fn now_s() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

/// Reads the logins of a file; invalid lines end only their login.
fn read(file: &Path) -> BTreeMap<String, u64> {
    let text = sinew_files::read_text(file, &sinew_files::Budget::SETTINGS);
    let text = text.unwrap_or_default();
    let line = |line: &str| {
        let (hash, end) = line.split_once(' ')?;
        Some((hash.to_owned(), end.parse().ok()?))
    };
    text.lines().filter_map(line).collect()
}

fn store(path: &Path, open: &BTreeMap<String, u64>) -> std::io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut file, temporary) = Temporary::create(folder_of(path), &name)?;
    #[cfg(unix)]
    file.set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o600))?;
    for (hash, end) in open {
        writeln!(file, "{hash} {end}")?;
    }
    file.sync_all()?;
    temporary.rename(&file, path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "0123456789abcdef";

    #[test]
    fn logins_end_on_the_server_and_survive_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("web-logins");
        let start = || Logins::new(Some(file.clone()), Arc::new(Health::new(1)));
        let logins = start();
        let [first, second] = [0, 1].map(|_| logins.add(TOKEN).unwrap());
        assert_ne!(first, second);
        logins.remove(TOKEN, &first);
        let again = start();
        assert!(!again.has(TOKEN, &first) && again.has(TOKEN, &second));
        assert!(!again.has("another token 123", &second), "a new token");
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(!text.contains(&second) && !text.contains(TOKEN), "{text}");
    }

    #[test]
    fn wrong_tokens_exclude_their_address_only() {
        let logins = Logins::new(None, Arc::new(Health::new(1)));
        let [one, other] = [[10, 0, 0, 1], [10, 0, 0, 2]].map(IpAddr::from);
        for _ in 1..MAX_WRONG_TOKENS {
            logins.count_wrong(one);
        }
        assert!(!logins.is_excluded(one));
        logins.count_wrong(one);
        assert!(logins.is_excluded(one) && !logins.is_excluded(other));
        // Addresses of one IPv6 network are one client.
        let of = |text: &str| text.parse::<IpAddr>().unwrap();
        for host in 0..MAX_WRONG_TOKENS {
            logins.count_wrong(of(&format!("2001:db8::{host:x}")));
        }
        assert!(
            logins.is_excluded(of("2001:db8::ffff")) && !logins.is_excluded(of("2001:db8:1::1"))
        );
    }
}
