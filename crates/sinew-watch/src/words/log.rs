//! Lines of the log of the monitor.

/// Reports that storing succeeds again after a failure.
pub fn store_recovered() -> String {
    "the store has recovered: records are stored again".into()
}

/// Reports that a transaction could not be stored.
pub fn store_failed(reason: &str) -> String {
    format!("storage failure: {reason}")
}

/// Reports that one transaction of a robot cannot be stored while others can.
pub fn transaction_rejected(robot: &str, reason: &str) -> String {
    format!("{robot}: a transaction cannot be stored: {reason}")
}

/// Reports that the last data of a robot were not stored before the monitor stopped.
pub fn last_data_lost(robot: &str) -> String {
    format!(
        "{robot}: the last data are lost: they could not be stored within the time limit of the shutdown"
    )
}

/// Reports that the records of a month could not be exported.
pub fn month_not_exported(reason: &str) -> String {
    format!("records of the month not exported: {reason}; the export is repeated later")
}

/// Reports that the recording of an incident could not be written.
pub fn recording_not_written(path: impl std::fmt::Display, reason: &str) -> String {
    format!("recording of an incident not written: {path}: {reason}")
}

/// Reports that the file with the records of a month was written, but not recorded in the store.
pub fn export_not_recorded(month: &str, reason: &str) -> String {
    format!("export of the records of {month} not recorded: {reason}; the file is written again")
}

/// Reports that old records of a robot could not be thinned.
pub fn not_thinned(robot: &str, reason: &str) -> String {
    format!("{robot}: old records not thinned: {reason}; repeated later")
}

/// Reports the location of a token of the page.
pub fn token_file(name: &str, path: impl std::fmt::Display) -> String {
    format!("the token '{name}' of the page is in the file {path}")
}

/// Reports a request with a wrong token.
pub fn wrong_token(address: impl std::fmt::Display) -> String {
    format!("request with a wrong token from {address}")
}

/// Reports that an address is excluded for a minute because of wrong tokens.
pub fn too_many_tokens(address: impl std::fmt::Display) -> String {
    format!("too many wrong tokens from {address}: its tokens are rejected for a minute")
}

/// Reports that the logins of the page could not be stored.
pub fn logins_not_stored(reason: impl std::fmt::Display) -> String {
    format!("logins of the page not stored: {reason}; they end with the monitor")
}

/// Reports that the configuration is invalid and was not reloaded.
pub fn not_reloaded(error: impl std::fmt::Display) -> String {
    format!("configuration not reloaded: {error}")
}

/// Reports that the configuration was reloaded.
pub fn reloaded() -> String {
    "configuration reloaded".into()
}

/// Reports the sections of the configuration whose changes require a restart.
pub fn needs_restart(sections: &str) -> String {
    format!("changes of {sections} take effect at the next start of the monitor")
}

/// Reports that the files of a robot are invalid.
pub fn robot_fault(robot: &str, reason: &str) -> String {
    format!("{robot}: {reason}")
}

/// Reports that the monitor of a robot was restarted to apply a new configuration.
pub fn robot_restarted(robot: &str, reason: impl std::fmt::Display) -> String {
    format!("{robot}: restarted: {reason}")
}

/// Reports that a transport is connected.
pub fn connected(transport: &str) -> String {
    format!("{transport}: connected")
}

/// Reports that a transport is disconnected.
pub fn disconnected(transport: &str, reason: &str) -> String {
    format!("{transport}: disconnected: {reason}; reconnecting")
}

/// Reports that the MQTT broker is not connected.
pub fn mqtt_disconnected(host: &str, reason: &str) -> String {
    format!("mqtt {host}: disconnected: {reason}; reconnecting")
}

/// Reports that a notification was discarded after the last attempt to deliver it.
pub fn notification_discarded(receiver: &str, attempts: u32, reason: &str) -> String {
    format!(
        "{receiver}: notification discarded after {attempts} attempts: {reason}; check the receiver"
    )
}
