//! Mail: submission over SMTP (RFC 5321, RFC 6409) with TLS, and the format of the messages (RFC 5322).

use crate::config::{Mail, MailTls};
use crate::hex::hex;
use crate::stream::{Stream, connect, secure};
use crate::token::secret;
use sinew_files::date::{DAY_S, civil};
use tokio::io::{AsyncBufReadExt as _, AsyncReadExt as _, AsyncWriteExt as _, BufReader};

/// Maximum length of a reply of a server, bytes.
const MAX_REPLY_BYTES: u64 = 64 * 1024;
/// Maximum number of bytes in an encoded word: the line of the subject has at most 76 characters (RFC 2047).
const WORD_BYTES: usize = 39;
/// Number of bytes in a line of a body: 76 characters in base 64 (RFC 2045).
const LINE_BYTES: usize = 57;

/// Text of a notification.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MailText {
    /// Subject, one line.
    pub(crate) subject: String,
    /// Body, lines of text.
    pub(crate) body: String,
}

/// Formats a message with header and body, lines ending in CR LF.
fn message(mail: &Mail, text: &MailText, time_utc_s: f64, number: &str) -> String {
    let mut subject = String::new();
    let mut rest = text.subject.as_str();
    while !rest.is_empty() {
        // A character is not divided between two words.
        let ends = rest.char_indices().map(|(at, c)| at + c.len_utf8());
        let end = ends.take_while(|end| *end <= WORD_BYTES).last();
        let (word, others) = rest.split_at(end.unwrap_or(rest.len()));
        let fold = if subject.is_empty() { "" } else { "\r\n " };
        subject += &format!("{fold}=?UTF-8?B?{}?=", base64(word.as_bytes()));
        rest = others;
    }
    let mut body = String::new();
    for line in text.body.as_bytes().chunks(LINE_BYTES) {
        body += &base64(line);
        body += "\r\n";
    }
    let (from, to) = (&mail.from, mail.to.join(",\r\n "));
    let (date, domain) = (date(time_utc_s), mail.domain());
    format!(
        "From: Sinew <{from}>\r\nTo: {to}\r\nSubject: {subject}\r\nDate: {date}\r\n\
         Message-ID: <{number}@{domain}>\r\nAuto-Submitted: auto-generated\r\nMIME-Version: 1.0\r\n\
         Content-Type: text/plain; charset=utf-8\r\nContent-Transfer-Encoding: base64\r\n\r\n{body}"
    )
}

/// Formats a time as RFC 5322 requires: `Mon, 30 Nov 2026 11:00:00 +0000`.
fn date(time_utc_s: f64) -> String {
    const DAYS: [&str; 7] = ["Thu", "Fri", "Sat", "Sun", "Mon", "Tue", "Wed"];
    const MONTHS: [&str; 12] = [
        "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
    ];
    let days = (time_utc_s / DAY_S).floor();
    let of_day = (time_utc_s - DAY_S * days) as u32;
    let (year, month, day) = civil(days as i64);
    let name = DAYS[(days as i64).rem_euclid(7) as usize];
    let month = MONTHS[(month - 1).rem_euclid(12) as usize];
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{name}, {day:02} {month} {year:04} {hour:02}:{minute:02}:{second:02} +0000")
}

/// Encodes bytes in base 64 with padding (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0, |bits, b| (bits << 8) | u32::from(*b));
        let bits = bits << (8 * (3 - three.len()));
        for k in 0..4 {
            let digit = DIGITS[((bits >> (18 - 6 * k)) & 63) as usize];
            text.push(if k <= three.len() { digit.into() } else { '=' });
        }
    }
    text
}

/// Dialogue with a server.
struct Session {
    stream: BufReader<Box<dyn Stream>>,
}

impl Session {
    /// Reads a reply and checks its class, the first digit of its code; returns its lines without the code.
    async fn reply(&mut self, class: u8) -> Result<Vec<String>, String> {
        let mut lines = Vec::new();
        let mut limited = (&mut self.stream).take(MAX_REPLY_BYTES);
        loop {
            let mut line = Vec::new();
            let read = limited.read_until(b'\n', &mut line).await;
            if read.map_err(|e| e.to_string())? == 0 {
                return Err(format!(
                    "connection closed, or reply longer than {MAX_REPLY_BYTES} bytes"
                ));
            }
            // The reply becomes a line of the log.
            let line = String::from_utf8_lossy(&line);
            let line: String = line
                .trim_end()
                .chars()
                .filter(|c| !c.is_control())
                .collect();
            let (Some(code), Some(text)) = (line.get(..3), line.get(3..)) else {
                return Err(format!("unexpected reply '{line}'"));
            };
            lines.push(text.get(1..).unwrap_or_default().to_owned());
            if text.starts_with('-') {
                continue;
            }
            return match code.as_bytes().first() == Some(&class) {
                true => Ok(lines),
                false => Err(format!("reply {code} {}", lines.join(" "))),
            };
        }
    }

    /// Sends a line and reads the reply.
    async fn command(&mut self, line: &str, class: u8) -> Result<Vec<String>, String> {
        let text = format!("{line}\r\n");
        let sent = async {
            self.stream.write_all(text.as_bytes()).await?;
            self.stream.flush().await
        };
        sent.await.map_err(|e: std::io::Error| e.to_string())?;
        self.reply(class).await
    }

    /// Begins the session; returns the extensions of the server in upper case.
    async fn hello(&mut self, mail: &Mail) -> Result<Vec<String>, String> {
        let lines = self
            .command(&format!("EHLO {}", mail.domain()), b'2')
            .await?;
        Ok(lines.iter().map(|line| line.to_uppercase()).collect())
    }

    /// Logs in with the method that the server offers.
    async fn log_in(
        &mut self,
        user: &str,
        password: &str,
        offers: &[String],
    ) -> Result<(), String> {
        let methods = offers.iter().find_map(|line| line.strip_prefix("AUTH "));
        let methods: Vec<&str> = methods.unwrap_or_default().split(' ').collect();
        if methods.contains(&"PLAIN") {
            let both = base64(format!("\0{user}\0{password}").as_bytes());
            self.command(&format!("AUTH PLAIN {both}"), b'2').await?;
        } else if methods.contains(&"LOGIN") {
            self.command("AUTH LOGIN", b'3').await?;
            self.command(&base64(user.as_bytes()), b'3').await?;
            self.command(&base64(password.as_bytes()), b'2').await?;
        } else {
            return Err("the server offers neither AUTH PLAIN nor AUTH LOGIN; remove user, or use another server".into());
        }
        Ok(())
    }
}

/// Sends a mail once; the server has accepted it when this returns. `mail.to` keeps the addresses that the server did not
/// accept, so that another attempt sends nothing twice.
///
/// # Errors
/// Returns the reason as text, with the reply of the server, unless it has accepted the mail for all addresses.
pub(crate) async fn send(mail: &mut Mail, text: &MailText, time_utc_s: f64) -> Result<(), String> {
    if mail.to.is_empty() {
        return Ok(());
    }
    let mut stream = connect(&mail.host, mail.port).await?;
    if mail.tls == MailTls::Implicit {
        stream = secure(stream, &mail.host, mail.ca_file.as_deref()).await?;
    }
    let mut session = Session {
        stream: BufReader::new(stream),
    };
    session.reply(b'2').await?;
    let mut offers = session.hello(mail).await?;
    if mail.tls == MailTls::StartTls {
        if !offers.iter().any(|line| line == "STARTTLS") {
            return Err("the server does not offer STARTTLS; set tls = \"implicit\" and its port, or use another server".into());
        }
        session.command("STARTTLS", b'2').await?;
        // Data that an attacker adds to the unencrypted reply would count as sent under TLS.
        if !session.stream.buffer().is_empty() {
            return Err("unexpected data before TLS".into());
        }
        let stream = session.stream.into_inner();
        let stream = secure(stream, &mail.host, mail.ca_file.as_deref()).await?;
        session.stream = BufReader::new(stream);
        offers = session.hello(mail).await?;
    }
    if let Some((user, file)) = mail.user.as_ref().zip(mail.password_file.as_ref()) {
        let password = secret(file)?;
        session.log_in(user, &password, &offers).await?;
    }
    session
        .command(&format!("MAIL FROM:<{}>", mail.from), b'2')
        .await?;
    let (mut rejected, mut reasons) = (Vec::new(), Vec::new());
    for to in &mail.to {
        if let Err(reason) = session.command(&format!("RCPT TO:<{to}>"), b'2').await {
            rejected.push(to.clone());
            reasons.push(format!("{to}: {reason}"));
        }
    }
    if rejected.len() == mail.to.len() {
        return Err(reasons.join("; "));
    }
    session.command("DATA", b'3').await?;
    let mut number = [0; 16];
    getrandom::fill(&mut number).map_err(|e| e.to_string())?;
    let content = message(mail, text, time_utc_s, &hex(&number));
    session.command(&format!("{content}."), b'2').await?;
    mail.to = rejected;
    // The mail is accepted, whether or not the server takes its leave.
    let _accepted = session.command("QUIT", b'2').await;
    match reasons.is_empty() {
        true => Ok(()),
        false => Err(reasons.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_rfc_4648() {
        for (text, encoded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(text.as_bytes()), encoded);
        }
        assert_eq!(base64(&[0xfb, 0xff]), "+/8=");
    }

    #[test]
    fn date_is_that_of_rfc_5322() {
        // date -u -R -d @1795564809, and of the last second before a leap day.
        assert_eq!(date(1_795_564_809.7), "Wed, 25 Nov 2026 00:00:09 +0000");
        assert_eq!(date(1_835_395_199.0), "Mon, 28 Feb 2028 23:59:59 +0000");
    }
}
