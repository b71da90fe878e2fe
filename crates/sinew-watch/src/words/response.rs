//! Reasons in error responses of the HTTP API, and the health text.

/// Reason of a failure to read the store.
pub const STORE_NOT_READ: &str = "reading the store failed; check the log of the monitor";
/// Reason for an unknown path.
pub const NOT_FOUND: &str = "not found";
/// Reason for a login with a wrong token.
pub const INVALID_TOKEN: &str = "invalid token";
/// Reason for a request without token.
pub const TOKEN_REQUIRED: &str =
    "token required: log in, or send the token in the Authorization header";
/// Reason for a Host header that names another host.
pub const UNKNOWN_HOST: &str = "unknown host name; add it to [web] host_names";
/// Reason for a request that writes without `x-sinew` header.
pub const HEADER_REQUIRED: &str = "missing header x-sinew: 1, required for writing";
/// Reason for a request body that is not JSON.
pub const JSON_REQUIRED: &str = "unsupported content type, expected application/json";
/// Reason for a request body beyond the limit.
pub const BODY_TOO_LONG: &str = "body too long, at most 64 KiB";
/// Reason for a request body that does not arrive in time.
pub const BODY_TOO_SLOW: &str = "body not complete within 10 s";
/// Reason for a request from a page of another site.
pub const CROSS_SITE: &str = "cross-site request rejected";
/// Reason for a command with a token that may only read.
pub const READ_ONLY: &str = "this token may only read; log in with a token of role operate";
/// Reason if the maximum number of exports is in progress.
pub const EXPORTS_BUSY: &str = "other exports are in progress; retry in a few seconds";
/// Reason if the maximum number of pages is connected.
pub const TOO_MANY_PAGES: &str = "too many pages are connected to the monitor; close some of them";
/// Reason if the robot has no state yet.
pub const IS_STARTING: &str = "the robot is being started; retry in a few seconds";
/// Reason if the robot was removed from the configuration.
pub const IS_GONE: &str = "the robot is not monitored any more";
/// Reason if the monitor has not answered a command in time.
pub const NO_RESULT: &str =
    "no result of the command yet; check the journal before the command is repeated";
/// Text of the test notification.
pub const TEST_NOTIFICATION: &str = "Test notification of Sinew watch; no action required";
/// Reason if a test notification is requested without a receiver.
pub const NO_RECEIVER: &str =
    "no receiver configured; add [[webhook]] or [[mail]] to the configuration";
/// Reason if an address has sent too many wrong tokens.
pub const TOO_MANY_TOKENS: &str = "too many wrong tokens from this address; retry in a minute";
/// Reason for a cursor of a record that does not exist.
pub const NO_CURSOR: &str = "no record with the number in `before`";
/// Health text of a working monitor.
pub const WORKS: &str = "works\n";
/// Health text of a monitor with a thread that hangs.
pub const HANGS: &str = "hangs\n";

/// Returns the reason if a robot of the configuration is not monitored.
pub fn not_monitored(robot: &str, reason: &str) -> String {
    format!("{robot} is not monitored: {reason}")
}

/// Returns the reason if a robot is not in the configuration.
pub fn no_robot(robot: &str) -> String {
    format!("robot '{robot}' not found")
}

/// Returns the reason if a robot has no tendon at a joint.
pub fn no_tendon(robot: &str, joint: &str, joints: &str) -> String {
    format!("{robot} has no tendon '{joint}'; its tendons: {joints}")
}

/// Returns the reason if an incident has no recording.
pub fn no_recording(robot: &str, number: u64) -> String {
    format!("{robot} has no recording of incident {number}")
}

/// Returns the reason if the period of the maintenance forecast is outside its range.
pub fn invalid_period(most: f64) -> String {
    format!("invalid within_days: expected more than 0 and at most {most} days")
}

/// Returns the reason if the body of a request is invalid.
pub fn invalid_body(error: impl std::fmt::Display) -> String {
    format!("invalid body: {error}")
}

/// Returns the reason if a command was executed, but could not be stored.
pub fn not_stored(reason: &str) -> String {
    format!(
        "command executed, but not stored yet: {reason}; the command is lost if the monitor stops before the store recovers"
    )
}
